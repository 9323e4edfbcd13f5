"""A second reader of OBJ, PLY, STL and glTF 2.0, written from the formats' specifications and not from lpvctl.

measure(path) returns (triangles, area) of what a viewer would show, in the file's units; Refused says why it cannot.
Compressed glTF is not decoded: the expected answer for such a file is that of the file it was made from.
"""
import base64
import json
import math
import os
import struct
import urllib.parse


class Refused(Exception):
    pass


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def length(a):
    return math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


def triangle_area(a, b, c):
    return length(cross(sub(b, a), sub(c, a))) / 2


def polygon_area(points):
    """Half the length of the vector area: exact for planar polygons, also concave ones."""
    if len(points) == 3:
        return triangle_area(*points)
    total = (0.0, 0.0, 0.0)
    for i in range(1, len(points) - 1):
        n = cross(sub(points[i], points[0]), sub(points[i + 1], points[0]))
        total = (total[0] + n[0], total[1] + n[1], total[2] + n[2])
    return length(total) / 2


def measure_polygons(points, polygons):
    triangles = 0
    area = 0.0
    for polygon in polygons:
        for corner in polygon:
            if not 0 <= corner < len(points):
                raise Refused(f'vertex {corner} of {len(points)}')
        if len(polygon) < 3:
            continue
        triangles += len(polygon) - 2
        area += polygon_area([points[corner] for corner in polygon])
    if triangles == 0:
        raise Refused('no triangle')
    used = {corner for polygon in polygons for corner in polygon}
    if not all(math.isfinite(x) for corner in used for x in points[corner]):
        raise Refused('not finite')
    if any(abs(x) > 1e9 for corner in used for x in points[corner]):
        raise Refused('beyond 1e9 m, the limit of lpvctl')
    return triangles, area


def read_obj(data):
    if data[:2] in (b'\xff\xfe', b'\xfe\xff'):
        raise Refused('UTF-16')
    text = data.decode('utf-8-sig', 'replace').replace('\r\n', '\n').replace('\r', '\n').replace('\\\n', ' ')
    counts = {'v': 0, 'vt': 0, 'vn': 0}
    points, polygons, checks = [], [], []
    for line in text.split('\n'):
        words = line.split('#')[0].split()
        if not words:
            continue
        if words[0] in counts:
            counts[words[0]] += 1
        if words[0] == 'v':
            values = [float(w) for w in words[1:]]
            if len(values) < 3:
                raise Refused('a vertex of fewer than 3 numbers')
            points.append(tuple(values[:3]))
        if words[0] in ('f', 'l', 'p'):
            polygon = []
            for corner in words[1:]:
                for kind, word in zip(('v', 'vt', 'vn'), corner.split('/')):
                    if not word and kind != 'v':
                        continue
                    try:
                        index = int(word)
                    except ValueError:
                        raise Refused(f'{word} is no index')
                    index = index - 1 if index > 0 else counts[kind] + index if index < 0 else -1
                    checks.append((kind, index))
                    if kind == 'v':
                        polygon.append(index)
            if words[0] == 'f':
                polygons.append(polygon)
    if any(not 0 <= index < counts[kind] for kind, index in checks):
        raise Refused('out of range')
    return measure_polygons(points, polygons)


PLY_TYPES = {'char': 'b', 'int8': 'b', 'uchar': 'B', 'uint8': 'B', 'short': 'h', 'int16': 'h', 'ushort': 'H',
             'uint16': 'H', 'int': 'i', 'int32': 'i', 'uint': 'I', 'uint32': 'I', 'float': 'f', 'float32': 'f',
             'double': 'd', 'float64': 'd'}


def read_ply(data):
    if data[:3] == b'\xef\xbb\xbf':
        data = data[3:]
    end = data.find(b'end_header')
    if not data.startswith(b'ply') or end < 0:
        raise Refused('header')
    body = data.index(b'\n', end) + 1
    form, elements = None, []
    for line in data[:end].decode('latin-1').splitlines():
        words = line.split()
        if words[:1] == ['format']:
            form = words[1]
        elif words[:1] == ['element']:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ['property']:
            elements[-1][2].append(words[1:])
    points, polygons = [], []
    words = iter(data[body:].split()) if form == 'ascii' else None
    order = '>' if form == 'binary_big_endian' else '<'
    at = [body]

    def value(kind):
        if words is not None:
            return float(next(words))
        code = order + PLY_TYPES[kind]
        out = struct.unpack_from(code, data, at[0])[0]
        at[0] += struct.calcsize(code)
        return out

    try:
        for name, count, properties in elements:
            for _ in range(count):
                row = {}
                for kind in properties:
                    if kind[0] == 'list':
                        row[kind[3]] = [int(value(kind[2])) for _ in range(int(value(kind[1])))]
                    else:
                        row[kind[1]] = value(kind[0])
                if name == 'vertex':
                    points.append((row['x'], row['y'], row['z']))
                corners = row.get('vertex_indices', row.get('vertex_index'))
                if name == 'face':
                    polygons.append(corners)
                if name == 'tristrips':
                    run = []
                    for corner in corners:
                        run = run + [corner] if corner != -1 else []
                        if len(run) >= 3:
                            polygons.append(run[-3:])
    except (StopIteration, RuntimeError, struct.error, ValueError):
        raise Refused('cut short')
    return measure_polygons(points, polygons)


def read_stl(data):
    text = data[3:] if data[:3] == b'\xef\xbb\xbf' else data
    if text.lstrip()[:5].lower() == b'solid' and b'\0' not in text[:512]:
        words = text.decode('latin-1').lower().split()
        if 'endsolid' not in words:
            raise Refused('cut short')
        points = [tuple(float(x) for x in words[i + 1:i + 4]) for i, word in enumerate(words) if word == 'vertex']
    else:
        if len(data) < 84 or len(data) < 84 + 50 * struct.unpack_from('<I', data, 80)[0]:
            raise Refused('cut short')
        points = []
        for i in range(struct.unpack_from('<I', data, 80)[0]):
            row = struct.unpack_from('<12f', data, 84 + 50 * i)
            points += [row[3:6], row[6:9], row[9:12]]
    return measure_polygons(points, [[i, i + 1, i + 2] for i in range(0, len(points) - 2, 3)])


COMPONENTS = {5120: ('b', 127), 5121: ('B', 255), 5122: ('h', 32767), 5123: ('H', 65535), 5125: ('I', 4294967295),
              5126: ('f', None)}
VECTORS = {'SCALAR': 1, 'VEC2': 2, 'VEC3': 3, 'VEC4': 4}


class Gltf:
    def __init__(self, path, data):
        self.binary = b''
        self.folder = os.path.dirname(path)
        if data[:4] == b'glTF':
            size = struct.unpack_from('<I', data, 12)[0]
            if len(data) < struct.unpack_from('<I', data, 8)[0]:
                raise Refused('cut short')
            text = data[20:20 + size]
            if len(data) > 28 + size:
                self.binary = data[28 + size:]
        else:
            text = data
        try:
            self.json = json.loads(text.decode('utf-8-sig').rstrip('\0 '))
        except ValueError:
            raise Refused('JSON')

    def item(self, name, index):
        items = self.json.get(name, [])
        if not 0 <= index < len(items):
            raise Refused(f'{name}[{index}] of {len(items)}')
        return items[index]

    def buffer(self, index):
        buffer = self.item('buffers', index)
        uri = buffer.get('uri')
        if uri is None:
            data = self.binary
        elif uri.startswith('data:'):
            data = base64.b64decode(uri.split(',', 1)[1] + '==')
        else:
            try:
                data = open(os.path.join(self.folder, urllib.parse.unquote(uri)), 'rb').read()
            except OSError:
                raise Refused('missing file')
        if len(data) < buffer['byteLength']:
            raise Refused('buffer too short')
        return data[:buffer['byteLength']]

    def elements(self, place, kind, width, normalised, count):
        code, largest = COMPONENTS[kind]
        size = struct.calcsize(code) * width
        if place.get('bufferView') is None:
            return [(0.0,) * width] * count
        view = self.item('bufferViews', place['bufferView'])
        start = view.get('byteOffset', 0)
        data = self.buffer(view['buffer'])
        if len(data) < start + view['byteLength']:
            raise Refused('view too long')
        data = data[start:start + view['byteLength']]
        stride = view.get('byteStride', size)
        first = place.get('byteOffset', 0)
        if count and first + stride * (count - 1) + size > len(data):
            raise Refused('accessor too long')
        rows = [struct.unpack_from('<' + code * width, data, first + stride * i) for i in range(count)]
        return [tuple(max(x / largest, -1.0) for x in row) for row in rows] if normalised and largest else rows

    def accessor(self, index):
        place = self.item('accessors', index)
        width = VECTORS[place['type']]
        kind, normalised, count = place['componentType'], place.get('normalized', False), place['count']
        rows = self.elements(place, kind, width, normalised, count)
        sparse = place.get('sparse')
        if sparse:
            where = self.elements(sparse['indices'], sparse['indices']['componentType'], 1, False, sparse['count'])
            values = self.elements(sparse['values'], kind, width, normalised, sparse['count'])
            rows = list(rows)
            for (i,), value in zip(where, values):
                if i >= count:
                    raise Refused('sparse index out of range')
                rows[i] = value
        return rows

    def primitive(self, place, matrix):
        if 'POSITION' not in place['attributes']:
            return 0, 0.0
        points = [transformed(matrix, p) for p in self.accessor(place['attributes']['POSITION'])]
        indices = [i for (i,) in self.accessor(place['indices'])] if 'indices' in place else list(range(len(points)))
        mode = place.get('mode', 4)
        if any(i >= len(points) for i in indices):
            raise Refused('index out of range')
        if mode == 4:
            polygons = [indices[i:i + 3] for i in range(0, len(indices) - 2, 3)]
        elif mode == 5:
            polygons = [indices[i:i + 3] for i in range(len(indices) - 2)]
        elif mode == 6:
            polygons = [[indices[0], indices[i], indices[i + 1]] for i in range(1, len(indices) - 1)]
        else:
            return 0, 0.0
        return measure_polygons(points, polygons)


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def transformed(m, p):
    return tuple(m[i][0] * p[0] + m[i][1] * p[1] + m[i][2] * p[2] + m[i][3] for i in range(3))


def matrix_of(node):
    if 'matrix' in node:
        return [[node['matrix'][4 * j + i] for j in range(4)] for i in range(4)]
    x, y, z, w = node.get('rotation', (0, 0, 0, 1))
    s = node.get('scale', (1, 1, 1))
    t = node.get('translation', (0, 0, 0))
    r = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
         [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
         [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    return [[r[i][j] * s[j] for j in range(3)] + [t[i]] for i in range(3)] + [[0, 0, 0, 1]]


def read_gltf(path, data):
    gltf = Gltf(path, data)
    nodes = gltf.json.get('nodes', [])
    if gltf.json.get('scenes'):
        roots = gltf.item('scenes', gltf.json.get('scene', 0)).get('nodes', [])
    else:
        children = {child for node in nodes for child in node.get('children', [])}
        roots = [i for i in range(len(nodes)) if i not in children]
    identity = [[float(i == j) for j in range(4)] for i in range(4)]
    open_nodes = [(root, identity) for root in roots]
    reached = set()
    triangles, area = 0, 0.0
    while open_nodes:
        index, parent = open_nodes.pop()
        node = gltf.item('nodes', index)
        if index in reached:
            raise Refused('node reached twice')
        reached.add(index)
        matrix = product(parent, matrix_of(node))
        open_nodes += [(child, matrix) for child in node.get('children', [])]
        if 'mesh' in node:
            for primitive in gltf.item('meshes', node['mesh'])['primitives']:
                more = gltf.primitive(primitive, matrix)
                triangles += more[0]
                area += more[1]
    if triangles == 0:
        raise Refused('no triangle')
    return triangles, area


def measure(path):
    with open(path, 'rb') as file:
        data = file.read()
    extension = os.path.splitext(path)[1].lower()
    if not data:
        raise Refused('empty')
    if extension in ('.glb', '.gltf'):
        return read_gltf(path, data)
    return {'.obj': read_obj, '.ply': read_ply, '.stl': read_stl}[extension](data)
