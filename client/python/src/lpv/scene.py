"""What scenes and edits are made of: short ways to the messages of proto/lpv/v1/scene.proto."""

from __future__ import annotations

from typing import Any, Sequence

import numpy as np
from google.protobuf import field_mask_pb2
from google.protobuf.descriptor import EnumDescriptor
from numpy.typing import ArrayLike, NDArray

from lpv.v1 import blob_pb2, geometry_pb2, scene_pb2, session_pb2

Vector = Sequence[float]


def vec3(value: Vector) -> geometry_pb2.Vec3:
    x, y, z = value
    return geometry_pb2.Vec3(x=x, y=y, z=z)


def enum(kind: Any, name: str | int) -> Any:
    """"accurate" of Quality is QUALITY_ACCURATE; a number is itself. ValueError names what there is."""
    if isinstance(name, int):
        return name
    descriptor: EnumDescriptor = getattr(kind, "DESCRIPTOR", kind)
    prefix = descriptor.values[0].name.removesuffix("UNSPECIFIED")
    wanted = prefix + name.upper().replace("-", "_")
    if wanted not in descriptor.values_by_name:
        known = ", ".join(value.name.removeprefix(prefix).lower() for value in descriptor.values[1:])
        raise ValueError(f"\"{name}\" is none of {known}")
    return descriptor.values_by_name[wanted].number


def settings(grid: int | None = None, **fields: Any) -> session_pb2.SessionSettings:
    """`grid`: cells along the longest edge. Others as SessionSettings has them, enumerators as words: "accurate"."""
    out = session_pb2.SessionSettings()
    if grid is not None:
        out.grid.longest = grid
    for name, value in fields.items():
        field = out.DESCRIPTOR.fields_by_name.get(name)
        if field is None:
            known = ", ".join(sorted(out.DESCRIPTOR.fields_by_name))
            raise ValueError(f"there is no setting \"{name}\"; there are {known}")
        if field.message_type is not None:
            getattr(out, name).CopyFrom(value)
        else:
            setattr(out, name, enum(field.enum_type, value) if field.enum_type is not None else value)
    return out


def transform(translation: Vector | None = None, rotation: Vector | None = None, scale: Vector | float | None = None,
              matrix: ArrayLike | None = None) -> geometry_pb2.Transform:
    """`rotation`: a unit quaternion x, y, z, w. `matrix`: 4 x 4, rows and columns as written, instead of the others."""
    out = geometry_pb2.Transform()
    if translation is not None:
        out.translation.CopyFrom(vec3(translation))
    if rotation is not None:
        x, y, z, w = rotation
        out.rotation.CopyFrom(geometry_pb2.Quaternion(x=x, y=y, z=z, w=w))
    if scale is not None:
        out.scale.CopyFrom(vec3((scale,) * 3 if isinstance(scale, (int, float)) else scale))
    if matrix is not None:
        out.matrix.extend(np.asarray(matrix, np.float64).reshape(4, 4).T.ravel())  # column-major
    return out


def matrix_of(placed: geometry_pb2.Transform) -> NDArray[np.float64]:
    """The 4 x 4 matrix, world from object, of a transform without one: geometry.proto writes it out."""
    out = np.eye(4)
    if placed.HasField("rotation"):
        x, y, z, w = placed.rotation.x, placed.rotation.y, placed.rotation.z, placed.rotation.w
        out[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                       [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                       [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    if placed.HasField("scale"):
        out[:3, :3] *= [placed.scale.x, placed.scale.y, placed.scale.z]
    out[:3, 3] = [placed.translation.x, placed.translation.y, placed.translation.z]
    return out


def mesh(positions: ArrayLike, triangles: ArrayLike, normals: ArrayLike | None = None,
         uvs: ArrayLike | None = None) -> blob_pb2.Mesh:
    """Vertices (n, 3) in metres; triangles (m, 3), counter-clockwise seen from the side that emits."""

    def packed(values: ArrayLike | None, kind: str) -> bytes:
        return b"" if values is None else np.ascontiguousarray(values, kind).tobytes()

    return blob_pb2.Mesh(positions=packed(positions, "<f4"), indices=packed(triangles, "<u4"),
                         normals=packed(normals, "<f4"), uvs=packed(uvs, "<f4"))


def quad(width: float, depth: float | None = None) -> blob_pb2.Mesh:
    """A rectangle in the plane y = 0 about the origin that faces up; a square where one edge is given."""
    x, z = width / 2, (width if depth is None else depth) / 2
    return mesh([[-x, 0, -z], [-x, 0, z], [x, 0, z], [x, 0, -z]], [[0, 1, 2], [0, 2, 3]])


_PLACED = ("translation", "rotation", "scale", "matrix")


def _object(kind: Any, name: str, shape: blob_pb2.Mesh | str, fields: dict[str, Any]) -> Any:
    out = kind(name=name)
    if isinstance(shape, str):
        out.mesh = shape
    else:
        out.inline_mesh.CopyFrom(shape)
    placed = {key: fields.pop(key) for key in _PLACED if key in fields}
    if placed:
        out.transform.CopyFrom(transform(**placed))
    _fill(out, fields)
    return out


def _fill(out: Any, fields: dict[str, Any]) -> None:
    for name, value in fields.items():
        field = out.DESCRIPTOR.fields_by_name.get(name)
        if field is None:
            raise ValueError(f"a {out.DESCRIPTOR.name.lower()} has no field \"{name}\"")
        if field.message_type is not None:
            getattr(out, name).CopyFrom(value if hasattr(value, "DESCRIPTOR") else vec3(value))
        else:
            setattr(out, name, enum(field.enum_type, value) if field.enum_type is not None else value)


def light(name: str, shape: blob_pb2.Mesh | str, **fields: Any) -> scene_pb2.Operation:
    """Creates a light: a mesh, or the hash that Session.upload gave, and what else Light has: radiance=(8, 6, 3),
    translation, rotation, scale or matrix, group, two_sided ..."""
    return scene_pb2.Operation(create_light=_object(scene_pb2.Light, name, shape, fields))


def surface(name: str, shape: blob_pb2.Mesh | str, **fields: Any) -> scene_pb2.Operation:
    """Creates a surface: albedo=(.8, .8, .8), translation ..."""
    return scene_pb2.Operation(create_surface=_object(scene_pb2.Surface, name, shape, fields))


def _update(out: Any, fields: dict[str, Any]) -> field_mask_pb2.FieldMask:
    """Fills `out` with the fields and names them, and nothing else, in a mask."""
    paths = ["transform" if key == "matrix" else f"transform.{key}" if key in _PLACED else key for key in fields]
    placed = {key: fields.pop(key) for key in _PLACED if key in fields}
    if placed:
        out.transform.CopyFrom(transform(**placed))
    _fill(out, fields)
    return field_mask_pb2.FieldMask(paths=paths)


def change_light(name: str, **fields: Any) -> scene_pb2.Operation:
    """Changes these fields and no others, so that somebody else may change others meanwhile: translation=(1, 2, 0)."""
    out = scene_pb2.Light(name=name)
    mask = _update(out, dict(fields))
    return scene_pb2.Operation(update_light=scene_pb2.UpdateLight(light=out, update_mask=mask))


def change_surface(name: str, **fields: Any) -> scene_pb2.Operation:
    out = scene_pb2.Surface(name=name)
    mask = _update(out, dict(fields))
    return scene_pb2.Operation(update_surface=scene_pb2.UpdateSurface(surface=out, update_mask=mask))


def delete_light(name: str) -> scene_pb2.Operation:
    return scene_pb2.Operation(delete_light=name)


def delete_surface(name: str) -> scene_pb2.Operation:
    return scene_pb2.Operation(delete_surface=name)


def set_vertices(name: str, positions: ArrayLike, normals: ArrayLike | None = None) -> scene_pb2.Operation:
    """New vertices for the mesh of a light or surface: the ordinary way for one that deforms."""
    moved = mesh(positions, [], normals)
    return scene_pb2.Operation(set_vertices=scene_pb2.SetVertices(object=name, positions=moved.positions,
                                                                  normals=moved.normals))


def fit_grid() -> scene_pb2.Operation:
    """Refits the grid to the scene, at the end of what creates it."""
    return scene_pb2.Operation(fit_grid=scene_pb2.FitGrid())


def camera(eye: Vector, target: Vector, up: Vector | None = None, fov_degrees: float = 0.0,
           name: str = "") -> geometry_pb2.Camera:
    """`fov_degrees`: vertical; 0 is the default of 50."""
    return geometry_pb2.Camera(name=name, eye=vec3(eye), target=vec3(target), up=None if up is None else vec3(up),
                               fov_degrees=fov_degrees)


def put_camera(one: geometry_pb2.Camera) -> scene_pb2.Operation:
    """Creates or replaces the session's camera of that name."""
    return scene_pb2.Operation(put_camera=one)
