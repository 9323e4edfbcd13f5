"""Files for what the formats allow beyond the ordinary, and for what they forbid.

cases() yields (name, bytes, expected): (triangles, area), or the words that the refusal must have.
"""
import base64
import json
import struct

SQUARE = 'v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n'
FACES = 'f 1 2 3\nf 1 3 4\n'
READ = (2, 1.0)
BOM = b'\xef\xbb\xbf'


def obj():
    yield 'plain', SQUARE + FACES, READ
    yield 'point', 'v 0 0 0\nv .5 0 0\nv .5 +.5 0\nv -.5 .5 0\n' + FACES, (2, 0.375)
    yield 'bom', BOM + (SQUARE + FACES).encode(), READ
    yield 'indented', '\n'.join(' \t' + line for line in (SQUARE + FACES).split('\n')), READ
    yield 'comment', SQUARE + 'f 1 2 3 # 4\nf 1 3 4# two\n', READ
    yield 'comment_first', '# an "exporter"\n\n' + SQUARE + FACES, READ
    yield 'vertex_comment', SQUARE.replace('0\n', '0 # here\n') + FACES, READ
    yield 'cr', (SQUARE + FACES).replace('\n', '\r'), READ
    yield 'crlf', (SQUARE + FACES).replace('\n', '\r\n'), READ
    yield 'continued', SQUARE + 'f 1 2 \\\n3\nf 1 \\\n  3 4\n', READ
    yield 'no_end', (SQUARE + FACES).rstrip(), READ
    yield 'quad', SQUARE + 'f 1 2 3 4\n', READ
    yield 'negative', SQUARE + 'f -4 -3 -2 -1\n', READ
    yield 'early_face', FACES + SQUARE, READ
    yield 'exponents', 'v 0 0 0\nv 1e0 0 0\nv 1.E+0 10e-1 0\nv 0 +1 0\n' + FACES, READ
    yield 'weights', SQUARE.replace('\nv', ' 1\nv') + FACES, READ
    yield 'colours', SQUARE.replace('0\n', '0 .5 .5 .5\n') + FACES, READ
    yield 'spaces', SQUARE.replace(' ', '   ') + FACES.replace(' ', '\t '), READ
    yield 'normals', SQUARE + 'vn 0 0 1\nf 1//1 2//1 3//1\nf 1//1 3//1 4//1\n', READ
    yield 'both', SQUARE + 'vt 0 0\nvn 0 0 1\nf 1/1/1 2/-1/-1 3/1/1 4/1/1\n', READ
    yield 'lines_too', SQUARE + 'l 1 2 3\np 4\n' + FACES, READ
    yield 'groups', SQUARE + 'g a\nf 1 2 3\ng b c\ns 1\nf 1 3 4\n', READ
    yield 'pentagon', 'v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 1 2 3 4 5\n', (3, 3.0)
    yield 'no_mtl', 'mtllib missing.mtl\n' + SQUARE + 'usemtl a\n' + FACES, READ
    yield 'range', SQUARE + 'f 1 2 9\n', 'vertex 9'
    yield 'zero', SQUARE + 'f 0 1 2\n', 'vertex 0'
    yield 'range_back', SQUARE + 'f -9 -1 -2\n', 'vertex -9'
    yield 'range_line', SQUARE + FACES + 'l 1 5\n', 'vertex 5'
    yield 'range_texture', SQUARE + 'vt 0 0\nf 1/1 2/7 3/1\n', 'texture coordinate 7'
    yield 'range_normal', SQUARE + 'f 1//1 2//1 3//1\n', 'normal 1'
    yield 'no_number', SQUARE + 'f 1 2 three\n', "'three'"
    yield 'huge_number', SQUARE + 'f 1 2 99999999999999999999\n', '99999999999999999999'
    yield 'points_only', SQUARE, 'no face'
    yield 'utf16', SQUARE.encode('utf-16'), 'UTF-16'
    yield 'not_finite', SQUARE.replace('v 1 1 0', 'v nan 1 0') + FACES, 'not finite'


def ply():
    def head(form, *elements):
        return f'ply\nformat {form} 1.0\ncomment by hand\n' + ''.join(elements) + 'end_header\n'

    def vertex(kind='float'):
        return 'element vertex 4\n' + ''.join(f'property {kind} {axis}\n' for axis in 'xyz')

    def face(lengths='uchar', items='int', count=2):
        return f'element face {count}\nproperty list {lengths} {items} vertex_indices\n'

    points, faces = '0 0 0\n1 0 0\n1 1 0\n0 1 0\n', '3 0 1 2\n3 0 2 3\n'
    numbers = [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0]
    strip = 'element tristrips 1\nproperty list int int vertex_indices\n'
    z = '0 0 0\n1 0 0\n0 1 0\n1 1 0\n'
    yield 'plain', head('ascii', vertex(), face()) + points + faces, READ
    yield 'crlf', (head('ascii', vertex(), face()) + points + faces).replace('\n', '\r\n'), READ
    yield 'bom', BOM + (head('ascii', vertex(), face()) + points + faces).encode(), READ
    yield 'faces_first', head('ascii', face(), vertex()) + faces + points, READ
    yield 'quad', head('ascii', vertex(), face(count=1)) + points + '4 0 1 2 3\n', READ
    yield 'index_name', head('ascii', vertex(), face().replace('indices', 'index')) + points + faces, READ
    yield 'strip', head('ascii', vertex(), strip) + z + '4 0 1 2 3\n', READ
    yield 'strip_restart', head('ascii', vertex(), strip) + z + '8 0 1 2 3 -1 0 1 3\n', (3, 1.5)
    yield 'strip_first', head('ascii', strip, vertex()) + '4 0 1 2 3\n' + z, READ
    yield 'strip_and_faces', head('ascii', vertex(), face(count=1), strip) + z + '3 0 1 2\n3 1 3 2\n', READ
    extra = vertex() + 'property uchar red\nproperty list uchar float w\n'
    yield 'extra', head('ascii', extra, face(), 'property uchar flags\n') + (
        '0 0 0 9 1 .5\n1 0 0 9 0\n1 1 0 9 2 1 1\n0 1 0 9 0\n3 0 1 2 7\n3 0 2 3 7\n'), READ
    edge = 'element edge 1\nproperty int vertex1\nproperty int vertex2\n'
    yield 'edges', head('ascii', vertex(), face(), edge) + points + faces + '0 1\n', READ
    yield 'edges_first', head('ascii', edge, vertex(), face()) + '0 1\n' + points + faces, READ
    for order, name in (('<', 'little'), ('>', 'big')):
        for real, code in (('float', 'f'), ('double', 'd')):
            for item, letter in (('int', 'i'), ('uint', 'I'), ('ushort', 'H'), ('uchar', 'B')):
                data = struct.pack(order + '12' + code, *numbers)
                lists = b''.join(struct.pack(order + 'B3' + letter, 3, *f) for f in ((0, 1, 2), (0, 2, 3)))
                form = f'binary_{name}_endian'
                yield f'{name}_{real}_{item}', head(form, vertex(real), face(items=item)).encode() + data + lists, READ
                if real == 'float' and item in ('int', 'ushort'):
                    yield f'{name}_{item}_first', head(form, face(items=item), vertex()).encode() + lists + data, READ
    yield 'range', head('ascii', vertex(), face()) + points + '3 0 1 2\n3 0 1 9\n', 'vertex 9'
    yield 'negative', head('ascii', vertex(), face()) + points + '3 0 1 -1\n3 0 1 2\n', 'vertex -1'
    yield 'strip_range', head('ascii', vertex(), strip) + z + '4 0 1 2 4\n', 'vertex 4'
    yield 'points_only', head('ascii', vertex()) + points, 'no face'
    yield 'cut', head('ascii', vertex(), face()) + points + '3 0 1 2\n', 'cut short'
    yield 'unknown_type', head('ascii', vertex('quad'), face()) + points + faces, 'header'
    yield 'not_finite', head('ascii', vertex(), face()) + points.replace('1 1', 'inf 1') + faces, 'not finite'


def stl():
    facet = ' facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 1 1 0\n  endloop\n endfacet\n'
    text = 'solid part\n' + facet + 'endsolid part\n'
    row = struct.pack('<12fH', 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0)
    one = (1, 0.5)
    yield 'plain', text, one
    yield 'upper', text.upper(), one
    yield 'mixed', text.title(), one
    yield 'bom', BOM + text.encode(), one
    yield 'indented', '  ' + text, one
    yield 'crlf', text.replace('\n', '\r\n'), one
    yield 'no_name', text.replace(' part', ''), one
    yield 'point', text.replace('1 0 0', '.5 0 0'), (1, 0.25)
    yield 'two_solids', text + text.replace('1 1 0', '1 -1 0'), READ
    yield 'empty_solid', 'solid none\nendsolid none\n' + text, one
    yield 'binary', b'made by hand'.ljust(80) + struct.pack('<I', 2) + row * 2, READ
    yield 'binary_solid', b'solid binary'.ljust(80) + struct.pack('<I', 1) + row, one
    yield 'no_facet', 'solid none\nendsolid none\n', 'no facet'
    yield 'no_facet_binary', b''.ljust(80) + struct.pack('<I', 0), 'no facet'
    yield 'half_vertex', text.replace('1 1 0', '1 1'), 'line 6'
    yield 'cut', text[:text.index('endsolid')], 'cut short'
    yield 'cut_binary', b''.ljust(80) + struct.pack('<I', 2) + row, 'cut short'


POSITIONS = struct.pack('<12f', 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0)
INDICES = struct.pack('<6H', 0, 1, 2, 0, 2, 3)


def scene(data=POSITIONS + INDICES):
    uri = 'data:application/octet-stream;base64,' + base64.b64encode(data).decode()
    return {
        'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': [0]}], 'nodes': [{'mesh': 0}],
        'meshes': [{'primitives': [{'attributes': {'POSITION': 0}, 'indices': 1}]}],
        'accessors': [{'bufferView': 0, 'componentType': 5126, 'count': 4, 'type': 'VEC3'},
                      {'bufferView': 1, 'componentType': 5123, 'count': 6, 'type': 'SCALAR'}],
        'bufferViews': [{'buffer': 0, 'byteLength': 48}, {'buffer': 0, 'byteOffset': 48, 'byteLength': 12}],
        'buffers': [{'byteLength': len(data), 'uri': uri}]}


def edited(expected, path, value, data=POSITIONS + INDICES):
    """A scene with the value at a path of keys changed, or the key removed if the value is None."""
    file = scene(data)
    at = file
    for key in path[:-1]:
        at = at[key]
    if value is None:
        del at[path[-1]]
    else:
        at[path[-1]] = value
    return file, expected


def quantised(code, kind, one, normalised):
    rows = [0, 0, 0, 0, one, 0, 0, 0, one, one, 0, 0, 0, one, 0, 0]
    data = struct.pack('<16' + code, *rows) + INDICES
    file = scene(data)
    size = struct.calcsize(code)
    file['accessors'][0].update({'componentType': kind, 'normalized': normalised})
    file['bufferViews'] = [{'buffer': 0, 'byteLength': 16 * size, 'byteStride': 4 * size},
                           {'buffer': 0, 'byteOffset': 16 * size, 'byteLength': 12}]
    file['extensionsUsed'] = file['extensionsRequired'] = ['KHR_mesh_quantization']
    return file


def gltf():
    yield 'plain', (scene(), READ)
    for code, kind, one, largest in (('b', 5120, 127, 127), ('B', 5121, 255, 255), ('h', 5122, 32767, 32767),
                                     ('H', 5123, 65535, 65535), ('b', 5120, -50, 127), ('h', 5122, 1000, 32767)):
        yield f'quantised_{kind}_{one}', (quantised(code, kind, one, False), (2, float(one * one)))
        yield f'normalised_{kind}_{one}', (quantised(code, kind, one, True), (2, (one / largest) ** 2))
    without = scene()
    del without['scene'], without['scenes']
    yield 'no_scenes', (without, READ)
    yield 'no_scene', edited(READ, ['scene'], None)
    yield 'strip', edited((2, 1.0), ['meshes', 0, 'primitives', 0], {'attributes': {'POSITION': 0}, 'mode': 5})
    yield 'fan', edited(READ, ['meshes', 0, 'primitives', 0], {'attributes': {'POSITION': 0}, 'mode': 6})
    yield 'points', edited('no triangle', ['meshes', 0, 'primitives', 0], {'attributes': {'POSITION': 0}, 'mode': 0})
    yield 'no_indices', edited((1, 0.5), ['meshes', 0, 'primitives', 0, 'indices'], None)
    yield 'scaled', edited((2, 6.0), ['nodes', 0, 'scale'], [2, 3, 4])
    yield 'matrix', edited((2, 4.0), ['nodes', 0, 'matrix'], [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 5, 5, 5, 1])
    shear = [1, 0, 0, 0, 0.5, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
    yield 'shear', edited(READ, ['nodes', 0, 'matrix'], shear)
    sparse = {'count': 1, 'indices': {'bufferView': 1, 'byteOffset': 2, 'componentType': 5123}, 'values': {'bufferView': 2}}
    file = scene(POSITIONS + INDICES + struct.pack('<3f', 2, 0, 0))
    file['bufferViews'].append({'buffer': 0, 'byteOffset': 60, 'byteLength': 12})
    file['accessors'][0]['sparse'] = sparse
    yield 'sparse', (file, (2, 1.5))
    yield 'unknown_used', edited(READ, ['extensionsUsed'], ['EXT_tomorrow'])
    yield 'unknown_required', edited('EXT_tomorrow', ['extensionsRequired'], ['EXT_tomorrow'])
    yield 'range_index', edited('index 2 is 9', ['scene'], 0, POSITIONS + struct.pack('<6H', 0, 1, 9, 0, 2, 3))
    yield 'range_accessor', edited('is 7', ['meshes', 0, 'primitives', 0, 'attributes', 'POSITION'], 7)
    yield 'range_indices', edited('is 7', ['meshes', 0, 'primitives', 0, 'indices'], 7)
    yield 'range_material', edited('material is 0', ['meshes', 0, 'primitives', 0, 'material'], 0)
    yield 'range_view', edited('bufferView is 9', ['accessors', 0, 'bufferView'], 9)
    yield 'range_buffer', edited('buffer is 3', ['bufferViews', 1, 'buffer'], 3)
    yield 'range_mesh', edited('mesh is 5', ['nodes', 0, 'mesh'], 5)
    yield 'range_node', edited('is 5', ['scenes', 0, 'nodes', 0], 5)
    yield 'range_scene', edited('scene is 5', ['scene'], 5)
    yield 'range_child', edited('is 3', ['nodes', 0, 'children'], [3])
    yield 'cycle', edited('reached twice', ['nodes', 0, 'children'], [0])
    yield 'count', edited('4800', ['accessors', 0, 'count'], 400)
    yield 'count_huge', edited('1000000000000', ['accessors', 0, 'count'], 10 ** 12)
    yield 'stride', edited('byteStride', ['bufferViews', 0, 'byteStride'], 4)
    yield 'view_long', edited('bufferViews[1]', ['bufferViews', 1, 'byteLength'], 100)
    yield 'buffer_long', edited('buffers[0]', ['buffers', 0, 'byteLength'], 100)
    yield 'missing', edited('none.bin', ['buffers', 0, 'uri'], 'none.bin')
    yield 'remote', edited('https', ['buffers', 0, 'uri'], 'https://example.org/a.bin')
    yield 'type', edited('VEC9', ['accessors', 0, 'type'], 'VEC9')
    yield 'component', edited('5124', ['accessors', 0, 'componentType'], 5124)
    yield 'mode', edited('is 9', ['meshes', 0, 'primitives', 0, 'mode'], 9)
    yield 'wrong_shape', edited('array', ['meshes'], {'a': 1})
    yield 'version', edited('3.0', ['asset', 'version'], '3.0')
    for missing in ('KHR_draco_mesh_compression', 'EXT_meshopt_compression'):
        file = scene()
        at = file['bufferViews'][0] if 'meshopt' in missing else file['meshes'][0]['primitives'][0]
        at['extensions'] = {missing: {'bufferView': 0, 'buffer': 0, 'byteLength': 48, 'byteStride': 12, 'count': 4,
                                      'mode': 'ATTRIBUTES', 'attributes': {'POSITION': 0}}}
        yield missing, (file, missing)


def cases():
    for extension, of in (('obj', obj), ('ply', ply), ('stl', stl)):
        for name, data, expected in of():
            yield f'{name}.{extension}', data if isinstance(data, bytes) else data.encode(), expected
    for name, (file, expected) in gltf():
        yield f'{name}.gltf', json.dumps(file).encode(), expected
    yield 'bom.gltf', BOM + json.dumps(scene()).encode(), READ
    yield 'not_json.gltf', b'{"asset":\n{"version" 2}}', 'line 2'
    yield 'deep.gltf', b'[' * 100000, 'nested'
    file = scene()
    file['buffers'][0]['uri'] = 'my%20buffer%25.bin'
    yield 'my buffer%.bin', POSITIONS + INDICES, None
    yield 'percent.gltf', json.dumps(file).encode(), READ
