// What is used of the decoder that comes with three.js, which the build makes a module (scripts/draco.mjs).
declare module "three/examples/jsm/libs/draco/gltf/draco_decoder.js" {
  export interface DracoAttribute {
    ptr: number;
    num_components(): number;
    data_type(): number;
    normalized(): boolean;
  }
  export interface DracoMesh {
    ptr: number;
    num_faces(): number;
  }
  interface Floats {
    size(): number;
    GetValue(index: number): number;
  }
  interface Decoder {
    DecodeArrayToMesh(bytes: Int8Array, length: number, into: DracoMesh): { ok(): boolean };
    GetAttributeByUniqueId(mesh: DracoMesh, id: number): DracoAttribute;
    GetAttributeFloatForAllPoints(mesh: DracoMesh, attribute: DracoAttribute, into: Floats): boolean;
    GetTrianglesUInt32Array(mesh: DracoMesh, bytes: number, at: number): boolean;
  }
  export interface DracoModule {
    Decoder: new () => Decoder;
    Mesh: new () => DracoMesh;
    DracoFloat32Array: new () => Floats;
    HEAPF32: Float32Array;
    _malloc(bytes: number): number;
    _free(at: number): void;
    destroy(object: object): void;
  }
  export default function createDecoder(): Promise<DracoModule>;
}
