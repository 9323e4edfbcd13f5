"""Renders a dumped scene with Blender's Cycles, inside Blender.

usage: blender -b --factory-startup -P tests/evaluation/cycles/render.py -- JOB.json

JOB.json: dump (folder of `reference_renderer --dump`), view (eye, target, up, fov), size, samples, bounces (a number, or
"all"), seed, threads, output (an OpenEXR file to write), split (least triangles of a light), filter
("box": a pixel is the mean over it; "centre"); gloss: whether what the camera sees has lobes; sky, if there is one: its
equirectangular picture; haze, if there is any (lower, upper: its box; extinction per metre, absorption: a share of
that, anisotropy), which scatters light once.

The file has Cycles' passes: Combined, Position, Normal, DiffCol; with haze VolumeDir, what that scatters. Lights emit from their
front unless they are two-sided; their backs, and those of one-sided surfaces, are black; the camera looks through the
latter. Nothing is clamped, no sample is left out for being weak.
"""

import json
import math
import pathlib
import sys

import bpy
import mathutils
import numpy as np

ALL_BOUNCES = 128


def array(data, place, kind, width):
    first, count = place
    return np.frombuffer(data, kind, count * width, first).reshape(count, width)


def split(vertices, normals, uvs, triangles, least):
    """The triangles cut into four each until there are `least`: Cycles chooses light samples by triangle, and is dark far
    from lights of few large ones."""
    attributes = [a for a in (vertices, normals, uvs) if len(a)]
    while len(triangles) < least:
        corners = triangles
        count = len(vertices)
        edges = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
        attributes = [np.concatenate([a, 0.5 * (a[edges[:, 0]] + a[edges[:, 1]])]) for a in attributes]
        n = len(corners)
        ab, bc, ca = (count + i * n + np.arange(n) for i in range(3))
        a, b, c = corners.T
        triangles = np.concatenate([np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
        vertices = attributes[0]
    rest = iter(attributes[1:])
    return vertices, next(rest) if len(normals) else normals, next(rest) if len(uvs) else uvs, triangles


def colour_socket(nodes, links, entry, folder):
    """A colour of at most 1 and the factor it is to be multiplied with."""
    colour = np.array(entry["colour"])
    scale = max(1.0, colour.max())
    node = nodes.new("ShaderNodeRGB")
    node.outputs[0].default_value = (*(colour / scale), 1.0)
    if "texture" not in entry:
        return node.outputs[0], scale
    image = nodes.new("ShaderNodeTexImage")
    image.image = bpy.data.images.load(str(folder / entry["texture"]), check_existing=True)
    image.image.colorspace_settings.name = "Non-Color"  # the texels are linear already
    image.interpolation, image.extension = "Linear", "REPEAT"
    mix = nodes.new("ShaderNodeMixRGB")
    mix.blend_type, mix.inputs[0].default_value = "MULTIPLY", 1.0
    links.new(node.outputs[0], mix.inputs[1])
    links.new(image.outputs["Color"], mix.inputs[2])
    return mix.outputs[0], scale


def number_socket(nodes, links, entry, key, colours):
    """Roughness or metalness: the number, times a channel of the gloss texture if there is one."""
    if colours is None:
        node = nodes.new("ShaderNodeValue")
        node.outputs[0].default_value = entry[key]
        return node.outputs[0]
    times = nodes.new("ShaderNodeMath")
    times.operation, times.inputs[1].default_value = "MULTIPLY", entry[key]
    links.new(colours.outputs["Green" if key == "roughness" else "Blue"], times.inputs[0])
    return times.outputs[0]


def glossy(nodes, links, entry, folder, albedo, matte):
    """A GGX lobe whose facets exchange light, over what is matte; the camera sees it, and light that goes from surface to
    surface meets what is matte alone. Metals have Schlick's term at the normal's angle, dielectrics the facets' own of
    an index of 1.5, which Principled has."""
    def math(operation, *values):
        node = nodes.new("ShaderNodeMath")
        node.operation = operation
        for socket, value in zip(node.inputs, values):
            if isinstance(value, float):
                socket.default_value = value
            else:
                links.new(value, socket)
        return node.outputs[0]

    def mixed(share, one, other):
        node = nodes.new("ShaderNodeMixRGB")
        links.new(share, node.inputs[0])
        for socket, value in ((node.inputs[1], one), (node.inputs[2], other)):
            if isinstance(value, float):
                socket.default_value = (value, value, value, 1.0)
            else:
                links.new(value, socket)
        return node.outputs[0]

    def over(share, below, above):
        node = nodes.new("ShaderNodeMixShader")
        for socket, value in zip(node.inputs, (share, below, above)):
            links.new(value, socket)
        return node.outputs[0]

    colours = None
    if "gloss" in entry:
        image = nodes.new("ShaderNodeTexImage")
        image.image = bpy.data.images.load(str(folder / entry["gloss"]), check_existing=True)
        image.image.colorspace_settings.name = "Non-Color"
        colours = nodes.new("ShaderNodeSeparateColor")
        links.new(image.outputs["Color"], colours.inputs[0])
    roughness, metalness = (number_socket(nodes, links, entry, key, colours) for key in ("roughness", "metalness"))
    geometry, towards = nodes.new("ShaderNodeNewGeometry"), nodes.new("ShaderNodeVectorMath")
    towards.operation = "DOT_PRODUCT"
    links.new(geometry.outputs["Normal"], towards.inputs[0])
    links.new(geometry.outputs["Incoming"], towards.inputs[1])
    edge = math("POWER", math("SUBTRACT", 1.0, math("ABSOLUTE", towards.outputs["Value"])), 5.0)

    def lobe_of(node, colour, **settings):
        shader = nodes.new(node)
        shader.distribution = "MULTI_GGX"
        for name, value in settings.items():
            shader.inputs[name].default_value = value
        links.new(roughness, shader.inputs["Roughness"])
        links.new(colour, shader.inputs[0])
        return shader.outputs[0]

    black = nodes.new("ShaderNodeRGB")
    black.outputs[0].default_value = (0, 0, 0, 1)
    nothing, both = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeAddShader")
    links.new(black.outputs[0], nothing.inputs[0])
    beneath = over(math("ADD", 0.04, math("MULTIPLY", 0.96, edge)), matte, nothing.outputs[0])
    links.new(beneath, both.inputs[0])
    links.new(lobe_of("ShaderNodeBsdfPrincipled", black.outputs[0], Specular=0.5), both.inputs[1])
    shown = over(metalness, both.outputs[0], lobe_of("ShaderNodeBsdfGlossy", mixed(edge, albedo, 1.0)))
    return over(nodes.new("ShaderNodeLightPath").outputs["Is Camera Ray"], matte, shown)


def material_of(entry, folder, gloss):
    material = bpy.data.materials.new("material")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    output = nodes.new("ShaderNodeOutputMaterial")
    colour, scale = colour_socket(nodes, links, entry, folder)
    shader = nodes.new("ShaderNodeEmission" if entry["emits"] else "ShaderNodeBsdfDiffuse")
    links.new(colour, shader.inputs["Color"])
    if entry["emits"]:
        shader.inputs["Strength"].default_value = scale
    front = shader.outputs[0]
    if gloss and not entry["emits"] and ("gloss" in entry or entry["roughness"] < 1 or entry["metalness"] > 0):
        front = glossy(nodes, links, entry, folder, colour, front)
    if entry["two_sided"]:
        links.new(front, output.inputs["Surface"])
        return material
    black = nodes.new("ShaderNodeBsdfDiffuse")
    black.inputs["Color"].default_value = (0, 0, 0, 1)
    back = black.outputs[0]
    if not entry["emits"]:
        seen, clear = nodes.new("ShaderNodeMixShader"), nodes.new("ShaderNodeBsdfTransparent")
        links.new(nodes.new("ShaderNodeLightPath").outputs["Is Camera Ray"], seen.inputs[0])
        links.new(back, seen.inputs[1])
        links.new(clear.outputs[0], seen.inputs[2])
        back = seen.outputs[0]
    sides = nodes.new("ShaderNodeMixShader")
    links.new(nodes.new("ShaderNodeNewGeometry").outputs["Backfacing"], sides.inputs[0])
    links.new(front, sides.inputs[1])
    links.new(back, sides.inputs[2])
    links.new(sides.outputs[0], output.inputs["Surface"])
    return material


def add_object(entry, data, folder, least, gloss):
    vertices = array(data, entry["positions"], "<f8", 3)
    normals = array(data, entry["normals"], "<f8", 3)
    uvs = array(data, entry["uvs"], "<f8", 2)
    triangles = array(data, entry["triangles"], "<u4", 3).astype(np.int64)
    if entry["emits"]:
        vertices, normals, uvs, triangles = split(vertices, normals, uvs, triangles, least)
    mesh = bpy.data.meshes.new("mesh")
    mesh.from_pydata(vertices.tolist(), [], triangles.tolist())
    if len(uvs):
        layer = mesh.uv_layers.new()
        corners = uvs[triangles.reshape(-1)] * (1, -1) + (0, 1)  # v = 0 is the lower edge there
        layer.data.foreach_set("uv", corners.astype(np.float32).reshape(-1))
    if len(normals) and not entry["emits"]:
        mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
        mesh.use_auto_smooth = True
        mesh.normals_split_custom_set_from_vertices(normals.tolist())
    mesh.materials.append(material_of(entry, folder, gloss))
    thing = bpy.data.objects.new("object", mesh)
    bpy.context.scene.collection.objects.link(thing)
    thing.cycles.shadow_terminator_offset = 0.0
    thing.cycles.shadow_terminator_geometry_offset = 0.0


def add_haze(haze):
    lower, upper = (mathutils.Vector(haze[key]) for key in ("lower", "upper"))
    material = bpy.data.materials.new("haze")
    material.use_nodes = True
    material.cycles.homogeneous_volume = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    scatter, absorb = nodes.new("ShaderNodeVolumeScatter"), nodes.new("ShaderNodeVolumeAbsorption")
    scatter.inputs["Color"].default_value, absorb.inputs["Color"].default_value = (1, 1, 1, 1), (0, 0, 0, 1)
    scatter.inputs["Density"].default_value = haze["extinction"] * (1 - haze["absorption"])
    absorb.inputs["Density"].default_value = haze["extinction"] * haze["absorption"]
    scatter.inputs["Anisotropy"].default_value = haze["anisotropy"]
    both, output = nodes.new("ShaderNodeAddShader"), nodes.new("ShaderNodeOutputMaterial")
    links.new(scatter.outputs[0], both.inputs[0])
    links.new(absorb.outputs[0], both.inputs[1])
    links.new(both.outputs[0], output.inputs["Volume"])
    bpy.ops.mesh.primitive_cube_add(size=1, location=0.5 * (lower + upper), scale=upper - lower)
    bpy.context.object.data.materials.append(material)


def add_sky(picture):
    """All around, as the server has it: its middle towards +x, its top towards +y."""
    world = bpy.context.scene.world
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    nodes.clear()
    where, turn, sky, light, output = (nodes.new(f"ShaderNode{name}") for name in (
        "TexCoord", "Mapping", "TexEnvironment", "Background", "OutputWorld"))
    turn.inputs["Rotation"].default_value = (0.5 * math.pi, 0, 0)  # up is +z there
    sky.image = bpy.data.images.load(picture)
    sky.image.colorspace_settings.name = "Non-Color"
    links.new(where.outputs["Generated"], turn.inputs["Vector"])
    links.new(turn.outputs["Vector"], sky.inputs["Vector"])
    links.new(sky.outputs["Color"], light.inputs["Color"])
    links.new(light.outputs[0], output.inputs["Surface"])


def add_camera(view):
    data = bpy.data.cameras.new("camera")
    data.sensor_fit = "VERTICAL"
    data.angle_y = math.radians(view["fov"])
    data.clip_start, data.clip_end = 0.01, 1e5
    camera = bpy.data.objects.new("camera", data)
    eye, target, up = (mathutils.Vector(view.get(key, (0, 1, 0))) for key in ("eye", "target", "up"))
    back = (eye - target).normalized()
    right = up.cross(back).normalized()
    above = back.cross(right)
    matrix = mathutils.Matrix((right, above, back)).transposed().to_4x4()
    matrix.translation = eye
    camera.matrix_world = matrix
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera


def set_up(job):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = job["size"]
    scene.render.resolution_percentage = 100
    scene.render.threads_mode, scene.render.threads = "FIXED", job["threads"]
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples, cycles.seed = job["samples"], job["seed"]
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    # A box is as wide as a pixel there, whatever the width.
    cycles.pixel_filter_type, cycles.filter_width = ("BOX", 1.0) if job["filter"] == "box" else ("GAUSSIAN", 0.01)
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.light_sampling_threshold = 0.0
    cycles.blur_glossy = 0.0
    bounces = ALL_BOUNCES if job["bounces"] == "all" else int(job["bounces"])
    cycles.max_bounces = cycles.diffuse_bounces = bounces
    if job["gloss"]:  # what a lobe shows has bounced as often as what the camera shows
        cycles.glossy_bounces, cycles.max_bounces = 1, bounces + 1
    cycles.transparent_max_bounces = 64
    scene.world = bpy.data.worlds.new("dark")
    scene.world.use_nodes = False
    scene.world.color = (0, 0, 0)
    layer = bpy.context.view_layer
    layer.cycles.use_pass_volume_direct = "haze" in job
    layer.use_pass_position = layer.use_pass_normal = layer.use_pass_diffuse_color = True
    scene.view_settings.view_transform = "Raw"
    image = scene.render.image_settings
    image.file_format, image.color_depth, image.exr_codec = "OPEN_EXR_MULTILAYER", "32", "ZIP"
    scene.render.use_file_extension = False
    scene.render.filepath = job["output"]


def main():
    job = json.loads(pathlib.Path(sys.argv[sys.argv.index("--") + 1]).read_text())
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    folder = pathlib.Path(job["dump"])
    data = (folder / "scene.bin").read_bytes()
    for entry in json.loads((folder / "scene.json").read_text()):
        add_object(entry, data, folder, job["split"], job["gloss"])
    if "haze" in job:
        add_haze(job["haze"])
    add_camera(job["view"])
    set_up(job)
    if "sky" in job:
        add_sky(job["sky"])
    bpy.ops.render.render(write_still=True)


main()
