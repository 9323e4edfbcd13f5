import {
  BufferAttribute, BufferGeometry, ClampToEdgeWrapping, Data3DTexture, DoubleSide, FloatType, GLSL3, HalfFloatType, LinearFilter, Matrix3, Matrix4,
  Mesh, NearestFilter, PerspectiveCamera, Quaternion, RawShaderMaterial, RGBAFormat, Scene, Vector3, WebGLRenderer, WebGLRenderTarget,
} from "three";
import type { Light, Surface } from "../../gen/lpv/v1/scene_pb.ts";
import type { Transform } from "../../gen/lpv/v1/geometry_pb.ts";
import { emittingArea, radianceOf } from "../scene/emission.ts";
import type { SceneModel } from "../scene/model.ts";
import { placementOf } from "../scene/placement.ts";
import type { View } from "../view/camera_rig.ts";
import { rendererName } from "../webgl.ts";
import type { Field } from "./field.ts";
import type { MeshData, Meshes } from "./meshes.ts";
import { fragment, MOST_LAYERS, vertex } from "./shaders.ts";

// As in server/scene/tonemap.h: the mean lightness of surfaces becomes that of this luminance.
const KEY = 0.18;
const METER = [64, 36] as const;
const DISTANCE = 5000; // metres; the camera sees twice as far
const UP = new Vector3(0, 1, 0);

type Textures = [Data3DTexture, Data3DTexture, Data3DTexture];
interface Uploaded {
  textures: Textures;
  shape: string; // fields of the same shape are blended
  scales: number[];
}
interface Drawn {
  mesh: Mesh<BufferGeometry, RawShaderMaterial>;
  variants: Map<string, RawShaderMaterial>; // of the same material, by what else is defined; "" is the shown one
  of: Light | Surface;
  data: MeshData;
}

// What a pixel receives, for tests: all of RGBA, rows from the bottom.
export interface Measured {
  irradiance: Float32Array; // a: 1 where a surface is seen
  position: Float32Array;
  normal: Float32Array;
}

// Draws surfaces in the light of a streamed volume, and lights, by WebGL2. Knows no network.
export class LocalRenderer {
  private readonly renderer: WebGLRenderer;
  private readonly most3d: number; // a context that is lost does not say it
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(50, 16 / 9, 0.01, 1e4);
  private readonly drawn = new Map<string, Drawn>();
  private readonly geometries = new Map<MeshData, BufferGeometry>();
  private readonly meter = new WebGLRenderTarget(METER[0], METER[1], { type: FloatType, minFilter: NearestFilter, magFilter: NearestFilter });
  private older: Uploaded | undefined;
  private newer: Uploaded | undefined;
  private readonly shared = {
    older: { value: [] as Data3DTexture[] }, newer: { value: [] as Data3DTexture[] },
    olderScale: { value: new Array<number>(MOST_LAYERS).fill(0) }, newerScale: { value: new Array<number>(MOST_LAYERS).fill(0) },
    weight: { value: new Array<number>(MOST_LAYERS).fill(1) },
    dims: { value: new Vector3(1, 1, 1) }, layers: { value: 0 }, origin: { value: new Vector3() }, cellSize: { value: 1 }, guard: { value: 0 },
    blend: { value: 1 }, exposure: { value: 1 }, worldFromEye: { value: new Matrix3() },
  };

  // `areaOf`: of a light's one side, m^2, which radiance from power needs.
  constructor(canvas: HTMLCanvasElement, private readonly areaOf: (light: Light) => number | undefined) {
    this.renderer = new WebGLRenderer({ canvas, antialias: false });
    this.renderer.setClearColor(0, 1);
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    this.most3d = Math.min(this.renderer.capabilities.maxTextureSize, Number(gl.getParameter(gl.MAX_3D_TEXTURE_SIZE)));
    this.scene.matrixWorldAutoUpdate = false;
  }

  get rendererName(): string {
    return rendererName(this.renderer.getContext());
  }

  // GL objects in use: geometries, textures, programs.
  get objects(): number {
    const { memory, programs } = this.renderer.info;
    return memory.geometries + memory.textures + (programs?.length ?? 0);
  }

  dispose(): void {
    this.setObjects(undefined, undefined);
    for (const set of [this.older, this.newer]) set?.textures.forEach((texture) => texture.dispose());
    this.meter.dispose();
    this.renderer.dispose();
  }

  // Why the volume cannot be shown here; empty where it can.
  setField(field: Field): string {
    const [x, y, z] = field.dims;
    const depth = z * field.layers;
    if (Math.max(x, y, depth) > this.most3d) return `The volume has ${x} x ${y} x ${depth} cells, this browser takes ${this.most3d} along an edge.`;
    const shape = `${x} ${y} ${depth} ${field.layers} ${field.origin} ${field.cellSize}`;
    const into = this.older?.shape === shape ? this.older : this.made(field, shape, depth);
    if (into !== this.older) this.older?.textures.forEach((texture) => texture.dispose());
    field.colours.forEach((halves, colour) => {
      const texture = into.textures[colour as 0 | 1 | 2];
      (texture.image.data as Uint16Array).set(halves);
      texture.needsUpdate = true;
    });
    into.scales = field.scales;
    const blends = this.newer?.shape === shape;
    this.older = this.newer ?? into;
    this.newer = into;
    const fill = (to: number[], from: number[]): void => from.forEach((value, i) => (to[i] = value));
    fill(this.shared.newerScale.value, into.scales);
    fill(this.shared.olderScale.value, this.older.scales);
    this.shared.newer.value = [...into.textures];
    this.shared.older.value = [...(blends ? this.older : into).textures];
    this.shared.dims.value.set(x, y, z);
    this.shared.layers.value = field.layers;
    this.shared.origin.value.set(...field.origin);
    this.shared.cellSize.value = field.cellSize;
    this.shared.guard.value = field.guard;
    this.setBlend(blends ? 0 : 1);
    return "";
  }

  // 0: what was there before, 1: the newest volume.
  setBlend(share: number): void {
    this.shared.blend.value = share;
  }

  setExposure(stops: number): void {
    this.shared.exposure.value = 2 ** stops;
  }

  // Takes over what has changed in the scene; what has no mesh yet is not drawn.
  setObjects(model: SceneModel | undefined, meshes: Meshes | undefined): void {
    const wanted = new Set<string>();
    for (const surface of model?.surfaces.values() ?? []) if (surface.visibleToCamera !== false) this.put(surface, "albedo", meshes, wanted);
    for (const light of model?.lights.values() ?? []) {
      if (light.visibleToCamera !== false && light.enabled !== false) this.put(light, "emits", meshes, wanted);
    }
    for (const [name, drawn] of this.drawn) {
      if (wanted.has(name)) continue;
      this.drop(drawn);
      this.drawn.delete(name);
    }
    const used = new Set([...this.drawn.values()].map(({ data }) => data));
    for (const [data, geometry] of this.geometries) {
      if (used.has(data)) continue;
      geometry.dispose();
      this.geometries.delete(data);
    }
  }

  draw(view: View, width: number, height: number): void {
    this.renderer.setSize(width, height, false);
    this.look(view, width / height);
    this.renderer.setRenderTarget(null);
    this.renderer.render(this.scene, this.camera);
  }

  // The automatic exposure of what the camera sees, stops; undefined where it sees no lit surface.
  metered(view: View, aspect: number): number | undefined {
    const pixels = new Float32Array(METER[0] * METER[1] * 4);
    this.look(view, aspect);
    this.as(["LINEAR"], this.meter, () => this.renderer.readRenderTargetPixels(this.meter, 0, 0, METER[0], METER[1], pixels));
    let sum = 0;
    let count = 0;
    for (let i = 0; i < pixels.length; i += 4) {
      if ((pixels[i + 3] ?? 0) <= 0) continue;
      sum += Math.cbrt(0.2126 * (pixels[i] ?? 0) + 0.7152 * (pixels[i + 1] ?? 0) + 0.0722 * (pixels[i + 2] ?? 0));
      count += 1;
    }
    return sum > 0 ? Math.log2(KEY) - 3 * Math.log2(sum / count) : undefined;
  }

  // `exact`: eight texels with weights in floats instead of the texture unit's.
  measure(view: View, width: number, height: number, exact: boolean): Measured {
    const target = new WebGLRenderTarget(width, height, { type: FloatType, count: 3, minFilter: NearestFilter, magFilter: NearestFilter });
    const read = (index: number): Float32Array => {
      const pixels = new Float32Array(width * height * 4);
      this.renderer.readRenderTargetPixels(target, 0, 0, width, height, pixels, undefined, index);
      return pixels;
    };
    this.look(view, width / height);
    let out: Measured | undefined;
    this.as(exact ? ["MEASURED", "EXACT"] : ["MEASURED"], target, () => (out = { irradiance: read(0), position: read(1), normal: read(2) }));
    target.dispose();
    if (!out) throw new Error("nothing was measured");
    return out;
  }

  private as(defines: readonly string[], target: WebGLRenderTarget, read: () => void): void {
    for (const drawn of this.drawn.values()) drawn.mesh.material = variantOf(drawn, defines);
    this.renderer.setRenderTarget(target);
    this.renderer.setClearAlpha(0);
    this.renderer.render(this.scene, this.camera);
    read();
    this.renderer.setRenderTarget(null);
    this.renderer.setClearAlpha(1);
    for (const drawn of this.drawn.values()) drawn.mesh.material = variantOf(drawn, []);
  }

  private look(view: View, aspect: number): void {
    const { camera } = this;
    camera.fov = view.fovDegrees;
    camera.aspect = aspect;
    camera.position.set(view.eye.x, view.eye.y, view.eye.z);
    camera.up.copy(UP);
    camera.lookAt(view.target.x, view.target.y, view.target.z);
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    this.shared.worldFromEye.value.setFromMatrix4(camera.matrixWorld);
    for (const { mesh, of } of this.drawn.values()) if ("distant" in of && of.distant) mesh.matrixWorld.copy(aroundEye(of, camera.position));
  }

  private put(object: Light | Surface, kind: "albedo" | "emits", meshes: Meshes | undefined, wanted: Set<string>): void {
    const before = this.drawn.get(object.name);
    if (before?.of === object) {
      wanted.add(object.name);
      return;
    }
    const data = meshes?.get(object.mesh);
    if (!data) {
      if (before) wanted.add(object.name);
      return;
    }
    wanted.add(object.name);
    if (before && before.data !== data) this.drop(before);
    const mesh = before?.data === data ? before.mesh : this.meshOf(data, kind);
    mesh.matrixWorld.copy(matrixOf(object.transform));
    const { uniforms } = mesh.material;
    (uniforms["worldNormal"]?.value as Matrix3).getNormalMatrix(mesh.matrixWorld);
    if ("albedo" in object) {
      (uniforms["albedo"]?.value as Vector3).set(object.albedo?.x ?? 0.8, object.albedo?.y ?? 0.8, object.albedo?.z ?? 0.8);
    } else {
      const light = object as Light;
      const radiance = radianceOf(light, emittingArea(light, this.areaOf(light) ?? NaN));
      (uniforms["front"]?.value as Vector3).set(radiance.x, radiance.y, radiance.z);
      (uniforms["back"]?.value as Vector3).set(radiance.x, radiance.y, radiance.z).multiplyScalar(object.twoSided ? 1 : 0);
    }
    const variants = before?.data === data ? before.variants : new Map([["", mesh.material]]);
    this.drawn.set(object.name, { mesh, variants, of: object, data });
  }

  private drop({ mesh, variants }: Drawn): void {
    this.scene.remove(mesh);
    for (const material of variants.values()) material.dispose();
  }

  private meshOf(data: MeshData, kind: "albedo" | "emits"): Drawn["mesh"] {
    const material = new RawShaderMaterial({
      glslVersion: GLSL3, vertexShader: vertex, fragmentShader: fragment, side: DoubleSide,
      defines: { ...(data.normals ? { NORMALS: "" } : {}), ...(kind === "emits" ? { EMITS: "" } : {}) },
      uniforms: {
        ...this.shared, worldNormal: { value: new Matrix3() }, albedo: { value: new Vector3() }, front: { value: new Vector3() },
        back: { value: new Vector3() },
      },
    });
    const mesh = new Mesh(this.geometryOf(data), material);
    mesh.frustumCulled = false; // the whole scene is a few draws
    mesh.matrixAutoUpdate = false;
    this.scene.add(mesh);
    return mesh;
  }

  private geometryOf(data: MeshData): BufferGeometry {
    const known = this.geometries.get(data);
    if (known) return known;
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(data.positions, 3));
    if (data.normals) geometry.setAttribute("normal", new BufferAttribute(data.normals, 3));
    geometry.setIndex(new BufferAttribute(data.indices, 1));
    this.geometries.set(data, geometry);
    return geometry;
  }

  private made(field: Field, shape: string, depth: number): Uploaded {
    const one = (): Data3DTexture => {
      const texture = new Data3DTexture(new Uint16Array(field.colours[0].length), field.dims[0], field.dims[1], depth);
      texture.format = RGBAFormat;
      texture.type = HalfFloatType;
      texture.minFilter = texture.magFilter = LinearFilter;
      texture.wrapS = texture.wrapT = texture.wrapR = ClampToEdgeWrapping;
      texture.unpackAlignment = 1;
      return texture;
    };
    return { textures: [one(), one(), one()], shape, scales: field.scales };
  }
}

// Made once: a program that no material has is thrown away, and compiled again when it is wanted.
function variantOf({ variants }: Drawn, defines: readonly string[]): RawShaderMaterial {
  const shown = variants.get("") as RawShaderMaterial;
  const key = defines.join(" ");
  let variant = variants.get(key);
  if (!variant) {
    variant = shown.clone();
    variant.uniforms = shown.uniforms; // the same values, not copies
    for (const define of defines) variant.defines[define] = "";
    variants.set(key, variant);
  }
  return variant;
}

// What is far away is seen in the same directions from everywhere, behind everything else.
function aroundEye(light: Light, eye: Vector3): Matrix4 {
  return matrixOf(light.transform).premultiply(new Matrix4().makeScale(DISTANCE, DISTANCE, DISTANCE)).premultiply(new Matrix4().makeTranslation(eye));
}

function matrixOf(transform: Transform | undefined): Matrix4 {
  const { translation: t, rotation: r, scale: s } = placementOf(transform);
  return new Matrix4().compose(new Vector3(t.x, t.y, t.z), new Quaternion(r.x, r.y, r.z, r.w), new Vector3(s.x, s.y, s.z));
}
