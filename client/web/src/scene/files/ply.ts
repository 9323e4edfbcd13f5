import type { BufferGeometry } from "three";
import { NO_PLACEMENT, objectName, plainMaterial, stemOf, type FileContent, type Triangles } from "./parts.ts";

// A PLY: one mesh without a material.
export async function readPly(file: File): Promise<FileContent> {
  const { PLYLoader } = await import("three/examples/jsm/loaders/PLYLoader.js");
  const geometry = new PLYLoader().parse(await file.arrayBuffer());
  if (!geometry.getAttribute("normal")) geometry.computeVertexNormals(); // scans are smooth, as lpvctl has them
  const triangles = trianglesOf(geometry);
  if (!triangles) throw new Error(`${file.name}: there are no triangles in it.`);
  return { parts: [{ name: objectName(stemOf(file.name)), triangles, placement: NO_PLACEMENT, material: plainMaterial() }], cameras: [] };
}

function trianglesOf(geometry: BufferGeometry): Triangles | undefined {
  const floats = (attribute: string): Float32Array | undefined => {
    const given = geometry.getAttribute(attribute);
    return given && Float32Array.from(given.array);
  };
  const positions = floats("position");
  if (!positions || positions.length < 9) return undefined;
  const normals = floats("normal");
  const uvs = floats("uv")?.map((value, i) => (i % 2 === 1 ? 1 - value : value)); // v goes up in PLY
  const corners = geometry.index?.array ?? Uint32Array.from({ length: positions.length / 3 }, (_, i) => i);
  return {
    positions, indices: Uint32Array.from(corners).slice(0, corners.length - (corners.length % 3)),
    ...(normals ? { normals } : {}), ...(uvs ? { uvs } : {}),
  };
}
