"""Run by Blender: exports meshes with every exporter that it has, and prints what each file holds.

blender -b --factory-startup --python export_blender.py -- OUT
One line per file on stdout: BLENDER, the path, the triangles and the area in Blender's own mesh.
"""
import os
import sys

import bmesh
import bpy

out = sys.argv[sys.argv.index('--') + 1]
primitives = bpy.ops.mesh
SHAPES = {
    'cube': lambda: primitives.primitive_cube_add(size=2, location=(1, 2, 3), rotation=(0.3, 0.2, 0.1)),
    'sphere': lambda: primitives.primitive_uv_sphere_add(segments=24, ring_count=12, radius=0.7),
    'ico': lambda: primitives.primitive_ico_sphere_add(subdivisions=3, radius=5),
    'torus': lambda: primitives.primitive_torus_add(),
    'cone': lambda: primitives.primitive_cone_add(vertices=7, end_fill_type='TRIFAN'),
    'monkey': lambda: primitives.primitive_monkey_add(size=0.01),
    'grid': lambda: primitives.primitive_grid_add(x_subdivisions=20, y_subdivisions=9, size=300),
    'two': lambda: (primitives.primitive_cube_add(size=1, location=(4, 0, 0)),
                    primitives.primitive_ico_sphere_add(subdivisions=2, location=(-4, 0, 0))),
}
EXPORTS = {
    'glb': lambda p: bpy.ops.export_scene.gltf(filepath=p + '.glb', export_format='GLB'),
    'separate.gltf': lambda p: bpy.ops.export_scene.gltf(filepath=p + '_separate.gltf', export_format='GLTF_SEPARATE'),
    'embedded.gltf': lambda p: bpy.ops.export_scene.gltf(filepath=p + '_embedded.gltf', export_format='GLTF_EMBEDDED'),
    'obj': lambda p: bpy.ops.wm.obj_export(filepath=p + '.obj'),
    'old.obj': lambda p: bpy.ops.export_scene.obj(filepath=p + '_old.obj'),
    'ply': lambda p: bpy.ops.export_mesh.ply(filepath=p + '.ply', use_ascii=False),
    'text.ply': lambda p: bpy.ops.export_mesh.ply(filepath=p + '_text.ply', use_ascii=True),
    'stl': lambda p: bpy.ops.export_mesh.stl(filepath=p + '.stl', ascii=False),
    'text.stl': lambda p: bpy.ops.export_mesh.stl(filepath=p + '_text.stl', ascii=True),
}


def triangulate(thing):
    """Suzanne's quadrilaterals are not flat: their area depends on the diagonal that an importer takes."""
    mesh = bmesh.new()
    mesh.from_mesh(thing.data)
    bmesh.ops.triangulate(mesh, faces=mesh.faces)
    mesh.to_mesh(thing.data)
    thing.data.validate()  # as the exporters do: two of its triangles are the same


def measured():
    triangles, area = 0, 0.0
    for thing in bpy.context.scene.objects:
        mesh = bmesh.new()
        mesh.from_mesh(thing.data)
        bmesh.ops.transform(mesh, matrix=thing.matrix_world, verts=mesh.verts)
        bmesh.ops.triangulate(mesh, faces=mesh.faces)
        triangles += len(mesh.faces)
        area += sum(face.calc_area() for face in mesh.faces)
    return triangles, area


for shape, add in SHAPES.items():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for module in ('io_scene_gltf2', 'io_scene_obj', 'io_mesh_ply', 'io_mesh_stl'):
        try:
            bpy.ops.preferences.addon_enable(module=module)
        except Exception:
            pass
    add()
    if shape == 'monkey':
        triangulate(bpy.context.object)
    bpy.context.view_layer.update()
    triangles, area = measured()
    for name, export in EXPORTS.items():
        try:
            export(os.path.join(out, shape))
        except Exception as error:
            print('NOT EXPORTED', shape, name, str(error).splitlines()[-1])
            continue
        path = os.path.join(out, shape + ('.' if '.' not in name else '_') + name)
        print('BLENDER', path, triangles, repr(area), sep='\t')
