import type { CameraRig } from "./camera_rig.ts";

export interface NavigateOptions {
  busy(): boolean; // a gizmo has the pointer
  moved(): void;
  clicked(x: number, y: number, more: boolean): void; // CSS pixels within the element; with Ctrl or Shift
}

const CLICK_PIXELS = 4;
const KEYS_PER_SECOND = 60;
const FLY_METRES_PER_SECOND = 2.5;

// Pointer, wheel, touch and keys move the camera: drag orbits, with Shift or the right or middle button pans, with Alt
// looks around; the wheel or two fingers come closer; W A S D Q E fly.
export function navigate(element: HTMLElement, rig: CameraRig, options: NavigateOptions): void {
  steerByPointer(element, rig, options);
  steerByKeys(element, rig, options);
  element.addEventListener("wheel", (event) => {
    event.preventDefault();
    rig.dolly(Math.exp(event.deltaY * 0.001));
    options.moved();
  }, { passive: false });
}

function steerByPointer(element: HTMLElement, rig: CameraRig, options: NavigateOptions): void {
  const held = new Map<number, { x: number; y: number }>();
  let travelled = 0;
  let spread = 0;
  const apart = (): number => {
    const [a, b] = [...held.values()];
    return a && b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
  };
  element.addEventListener("contextmenu", (event) => event.preventDefault());
  element.addEventListener("pointerdown", (event) => {
    if (options.busy()) return;
    element.setPointerCapture(event.pointerId);
    held.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (held.size === 1) travelled = 0;
    spread = apart();
  });
  element.addEventListener("pointermove", (event) => {
    const last = held.get(event.pointerId);
    if (!last) return;
    const dx = event.clientX - last.x;
    const dy = event.clientY - last.y;
    held.set(event.pointerId, { x: event.clientX, y: event.clientY });
    travelled += Math.hypot(dx, dy);
    if (travelled <= CLICK_PIXELS) return;
    const height = element.clientHeight || 1;
    if (held.size === 2) {
      const now = apart();
      if (spread > 0 && now > 0) rig.dolly(spread / now);
      spread = now;
      rig.pan(dx / height / 2, dy / height / 2);
    } else if (event.shiftKey || event.buttons & 6) {
      rig.pan(dx / height, dy / height);
    } else if (event.altKey) {
      rig.look((-dx / height) * 2, (dy / height) * 2);
    } else {
      rig.orbit((-dx / height) * 4, (dy / height) * 4);
    }
    options.moved();
  });
  const release = (event: PointerEvent): void => {
    const was = held.get(event.pointerId);
    held.delete(event.pointerId);
    if (was && held.size === 0 && travelled <= CLICK_PIXELS && event.type === "pointerup" && event.button === 0) {
      const box = element.getBoundingClientRect();
      options.clicked(event.clientX - box.left, event.clientY - box.top, event.ctrlKey || event.metaKey || event.shiftKey);
    }
  };
  element.addEventListener("pointerup", release);
  element.addEventListener("pointercancel", release);
}

function steerByKeys(element: HTMLElement, rig: CameraRig, options: NavigateOptions): void {
  const down = new Set<string>();
  let timer: ReturnType<typeof setInterval> | undefined;
  const step = (): void => {
    const way = FLY_METRES_PER_SECOND / KEYS_PER_SECOND;
    const turn = 1.5 / KEYS_PER_SECOND;
    const pair = (more: string, less: string): number => Number(down.has(more)) - Number(down.has(less));
    rig.fly(way * pair("KeyD", "KeyA"), way * pair("KeyE", "KeyQ"), way * pair("KeyW", "KeyS"));
    rig.orbit(turn * pair("ArrowRight", "ArrowLeft"), turn * pair("ArrowUp", "ArrowDown"));
    options.moved();
  };
  const steers = /^(Key[WASDQE]|Arrow(Left|Right|Up|Down))$/;
  element.addEventListener("keydown", (event) => {
    if (!steers.test(event.code) || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    down.add(event.code);
    timer ??= setInterval(step, 1000 / KEYS_PER_SECOND);
  });
  const stopAt = (code?: string): void => {
    if (code) down.delete(code);
    else down.clear();
    if (down.size > 0 || timer === undefined) return;
    clearInterval(timer);
    timer = undefined;
  };
  element.addEventListener("keyup", (event) => stopAt(event.code));
  element.addEventListener("focusout", () => stopAt());
}
