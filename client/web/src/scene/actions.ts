import { create } from "@bufbuild/protobuf";
import { TransformSchema } from "../../gen/lpv/v1/geometry_pb.ts";
import type { EditAck } from "../../gen/lpv/v1/scene_pb.ts";
import { placementOf, type Placement } from "./placement.ts";
import type { Editor, LightInit, OperationInit, SurfaceInit } from "./editor.ts";
import type { SceneObject } from "./model.ts";

export type Fields = Omit<LightInit, "name" | "$typeName"> | Omit<SurfaceInit, "name" | "$typeName">;

// What people do to objects, as operations.
export function update(object: SceneObject, fields: Fields, paths: string[]): OperationInit {
  const name = object.value.name;
  const updateMask = { paths };
  return object.kind === "light"
    ? { operation: { case: "updateLight", value: { light: { ...(fields as LightInit), name }, updateMask } } }
    : { operation: { case: "updateSurface", value: { surface: { ...(fields as SurfaceInit), name }, updateMask } } };
}

export function remove(object: SceneObject): OperationInit {
  return object.kind === "light"
    ? { operation: { case: "deleteLight", value: object.value.name } }
    : { operation: { case: "deleteSurface", value: object.value.name } };
}

// The same object again, under a name and at a place of its own.
export function copy(object: SceneObject, name: string, placement: Placement): OperationInit {
  const transform = create(TransformSchema, placement);
  return object.kind === "light"
    ? { operation: { case: "createLight", value: { ...object.value, name, transform } } }
    : { operation: { case: "createSurface", value: { ...object.value, name, transform } } };
}

// A name is not a field that changes: the object is made again under the new one and the old one removed, in one edit.
export async function rename(editor: Editor, object: SceneObject, name: string): Promise<EditAck | undefined> {
  return editor.apply([copy(object, name, placementOf(object.value.transform)), remove(object)]);
}

export async function duplicate(editor: Editor, objects: SceneObject[]): Promise<EditAck | undefined> {
  return editor.apply(objects.map((object) => {
    const placement = placementOf(object.value.transform);
    const { x, y, z } = placement.translation;
    return copy(object, object.value.name, { ...placement, translation: { x: x + 0.3, y, z: z + 0.3 } });
  }));
}

// Moving, turning and scaling: while one edit is under way the newest place waits, and the whole drag is one undo step.
export function place(editor: Editor, places: [SceneObject, Placement][], drag: string): Promise<EditAck | undefined> {
  const paths = ["transform.translation", "transform.rotation", "transform.scale"];
  const operations = places.map(([object, to]) => update(object, { transform: to }, paths));
  return editor.apply(operations, { key: `place ${places.map(([object]) => object.value.name).join("/")}`, undoGroup: drag });
}
