// Meshes that the page makes itself, as the protocol has them: float32 positions, uint32 indices, little-endian.
export interface MeshBytes {
  positions: Uint8Array;
  indices: Uint8Array;
  normals?: Uint8Array;
}

function littleEndian(values: number[], kind: "f32" | "u32"): Uint8Array {
  const view = new DataView(new ArrayBuffer(values.length * 4));
  values.forEach((value, i) => (kind === "f32" ? view.setFloat32(4 * i, value, true) : view.setUint32(4 * i, value, true)));
  return new Uint8Array(view.buffer);
}

// A square of edge 1 around the origin, seen from +z.
export function square(): MeshBytes {
  return {
    positions: littleEndian([-0.5, -0.5, 0, 0.5, -0.5, 0, 0.5, 0.5, 0, -0.5, 0.5, 0], "f32"),
    indices: littleEndian([0, 1, 2, 0, 2, 3], "u32"),
  };
}

// A sphere of radius .5 around the origin, smooth to the eye.
export function sphere(rings = 24, sectors = 48): MeshBytes {
  const positions: number[] = [];
  const indices: number[] = [];
  for (let ring = 0; ring <= rings; ++ring) {
    const polar = (Math.PI * ring) / rings;
    for (let sector = 0; sector <= sectors; ++sector) {
      const around = (2 * Math.PI * sector) / sectors;
      positions.push(0.5 * Math.sin(polar) * Math.cos(around), 0.5 * Math.cos(polar), -0.5 * Math.sin(polar) * Math.sin(around));
    }
  }
  for (let ring = 0; ring < rings; ++ring) {
    for (let sector = 0; sector < sectors; ++sector) {
      const a = ring * (sectors + 1) + sector;
      const b = a + sectors + 1;
      if (ring > 0) indices.push(a, b, a + 1);
      if (ring < rings - 1) indices.push(a + 1, b, b + 1);
    }
  }
  const normals = positions.map((value) => 2 * value);
  return { positions: littleEndian(positions, "f32"), indices: littleEndian(indices, "u32"), normals: littleEndian(normals, "f32") };
}
