"""Writes glTF 2.0 binary files: meshes with a colour each, or a glow, or a picture of either."""

import json
import struct
import zlib

import numpy as np


def png(pixels):
    """An 8-bit RGB array (height, width, 3) as a PNG file."""
    height, width, _ = pixels.shape
    rows = b"".join(b"\0" + row.tobytes() for row in np.ascontiguousarray(pixels, np.uint8))
    out = b"\x89PNG\r\n\x1a\n"
    for name, data in ((b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)), (b"IDAT", zlib.compress(rows)),
                       (b"IEND", b"")):
        out += struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    return out


class Scene:
    def __init__(self):
        self.gltf = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [],
                     "materials": [], "accessors": [], "bufferViews": [],
                     "extensionsUsed": ["KHR_materials_emissive_strength"]}
        self.binary = b""

    @classmethod
    def opened(cls, path):
        """A .glb file, to which objects are added."""
        data = path.read_bytes()
        length, = struct.unpack_from("<I", data, 12)
        size, = struct.unpack_from("<I", data, 20 + length)
        scene = cls()
        scene.gltf = {**scene.gltf, **json.loads(data[20:20 + length])}
        scene.gltf["extensionsUsed"] = sorted({*scene.gltf["extensionsUsed"], "KHR_materials_emissive_strength"})
        scene.binary = data[28 + length:28 + length + size]
        return scene

    def surface(self, name, mesh, albedo=(0.7, 0.7, 0.7), uvs=None, picture=None, one_sided=False, roughness=1.0,
                metalness=0.0, normals=None):
        """`picture`: 8-bit sRGB (height, width, 3), multiplies the albedo. `normals`: of the vertices; None: flat."""
        material = {"pbrMetallicRoughness": {"baseColorFactor": [*albedo, 1.0], "metallicFactor": metalness,
                                             "roughnessFactor": roughness},
                    "doubleSided": not one_sided}
        if picture is not None:
            material["pbrMetallicRoughness"]["baseColorTexture"] = {"index": self._texture(picture)}
        self._add(name, mesh, material, uvs, normals)

    def light(self, name, mesh, radiance, uvs=None, picture=None, two_sided=False):
        """`radiance`: W/(sr m^2), multiplied by the picture."""
        strength = max(radiance)
        material = {"emissiveFactor": [c / strength for c in radiance],
                    "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": strength}},
                    "doubleSided": two_sided}
        if picture is not None:
            material["emissiveTexture"] = {"index": self._texture(picture)}
        self._add(name, mesh, material, uvs)

    def write(self, path):
        self.gltf["buffers"] = [{"byteLength": len(self.binary)}]
        text = json.dumps(self.gltf).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(self.binary), b"BIN\0") + self.binary
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)

    def _view(self, data):
        self.binary += b"\0" * (-len(self.binary) % 4)
        self.gltf["bufferViews"].append({"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)})
        self.binary += data + b"\0" * (-len(data) % 4)
        return len(self.gltf["bufferViews"]) - 1

    def _accessor(self, array, component, kind, bounds=False):
        entry = {"bufferView": self._view(array.tobytes()), "componentType": component, "count": len(array), "type": kind}
        if bounds:
            entry.update(min=array.min(axis=0).tolist(), max=array.max(axis=0).tolist())
        self.gltf["accessors"].append(entry)
        return len(self.gltf["accessors"]) - 1

    def _texture(self, picture):
        images = self.gltf.setdefault("images", [])
        images.append({"bufferView": self._view(png(picture)), "mimeType": "image/png"})
        self.gltf.setdefault("textures", []).append({"source": len(images) - 1})
        return len(images) - 1

    def _add(self, name, mesh, material, uvs, normals=None):
        vertices, triangles = mesh
        attributes = {"POSITION": self._accessor(np.asarray(vertices, np.float32), 5126, "VEC3", bounds=True)}
        if normals is not None:
            attributes["NORMAL"] = self._accessor(np.asarray(normals, np.float32), 5126, "VEC3")
        if uvs is not None:
            attributes["TEXCOORD_0"] = self._accessor(np.asarray(uvs, np.float32), 5126, "VEC2")
        indices = self._accessor(np.asarray(triangles, np.uint32).reshape(-1), 5125, "SCALAR")
        self.gltf["materials"].append({"name": name, **material})
        self.gltf["meshes"].append({"name": name, "primitives": [
            {"attributes": attributes, "indices": indices, "material": len(self.gltf["materials"]) - 1}]})
        self.gltf["nodes"].append({"name": name, "mesh": len(self.gltf["meshes"]) - 1})
        self.gltf["scenes"][self.gltf["scene"]]["nodes"].append(len(self.gltf["nodes"]) - 1)
