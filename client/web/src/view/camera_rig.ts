// A camera that people steer: looks from `distance` at `target`; angles in radians, lengths in metres.
export interface Point {
  x: number;
  y: number;
  z: number;
}

export interface View {
  eye: Point;
  target: Point;
  fovDegrees: number;
}

const STEEPEST = (89 * Math.PI) / 180;
const add = (a: Point, b: Point, by = 1): Point => ({ x: a.x + by * b.x, y: a.y + by * b.y, z: a.z + by * b.z });

export class CameraRig {
  private target: Point = { x: 0, y: 1, z: 0 };
  private distance = 5;
  private yaw = 0; // about +y; 0 looks along -z
  private pitch = 0; // upwards positive: the eye is above the target
  private fov = 50;

  view(): View {
    return { eye: add(this.target, this.towardsEye(), this.distance), target: { ...this.target }, fovDegrees: this.fov };
  }

  set(view: View): void {
    const away = add(view.eye, view.target, -1);
    this.distance = Math.max(1e-3, Math.hypot(away.x, away.y, away.z));
    this.yaw = Math.atan2(away.x, away.z);
    this.pitch = clampPitch(Math.asin(Math.min(1, Math.max(-1, away.y / this.distance))));
    this.target = { ...view.target };
    this.fov = view.fovDegrees || 50;
  }

  // Around the target.
  orbit(yaw: number, pitch: number): void {
    this.yaw += yaw;
    this.pitch = clampPitch(this.pitch + pitch);
  }

  // Turns where it stands.
  look(yaw: number, pitch: number): void {
    const { eye } = this.view();
    this.orbit(yaw, pitch);
    this.target = add(eye, this.towardsEye(), -this.distance);
  }

  // In the picture's plane, as fractions of its height.
  pan(right: number, up: number): void {
    const height = 2 * this.distance * Math.tan((this.fov * Math.PI) / 360);
    this.target = add(add(this.target, this.rightward(), -right * height), this.upward(), up * height);
  }

  // Towards the target for factors below 1.
  dolly(factor: number): void {
    this.distance = Math.min(1e4, Math.max(0.05, this.distance * factor));
  }

  // The whole camera, metres to its right, up and ahead.
  fly(right: number, up: number, ahead: number): void {
    this.target = add(add(add(this.target, this.rightward(), right), { x: 0, y: 1, z: 0 }, up), this.towardsEye(), -ahead);
  }

  // So that a ball fills most of the picture.
  frame(centre: Point, radius: number): void {
    this.target = { ...centre };
    this.distance = Math.max(0.05, (1.3 * radius) / Math.sin((this.fov * Math.PI) / 360));
  }

  private towardsEye(): Point {
    const flat = Math.cos(this.pitch);
    return { x: flat * Math.sin(this.yaw), y: Math.sin(this.pitch), z: flat * Math.cos(this.yaw) };
  }

  private rightward(): Point {
    return { x: Math.cos(this.yaw), y: 0, z: -Math.sin(this.yaw) };
  }

  private upward(): Point {
    const steep = Math.sin(this.pitch);
    return { x: -steep * Math.sin(this.yaw), y: Math.cos(this.pitch), z: -steep * Math.cos(this.yaw) };
  }
}

function clampPitch(pitch: number): number {
  return Math.min(STEEPEST, Math.max(-STEEPEST, pitch));
}
