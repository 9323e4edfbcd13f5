"""Irradiance by closed forms, in double: polygons of one radiance (MATHS.md 5.1), what convex things leave of them, and
what a lit polygon reflects.

A polygon is an array (corners, 3) in metres, counter-clockwise seen from its front, and convex. Irradiance is for radiance
1 and in W/m^2, unless a function says otherwise.
"""

import numpy as np


def unclipped(receivers, normals, polygons):
    """Lambert's sum of every polygon at every receiver, (receivers, polygons): the irradiance of a polygon that shows its
    front and lies above the receiver's horizon. Receivers and normals (n, 3), polygons (m, corners, 3)."""
    v = polygons[None] - receivers[:, None, None]
    after = np.roll(v, -1, axis=2)
    cross = np.cross(v, after)
    sine = np.linalg.norm(cross, axis=-1)
    angle = np.arctan2(sine, np.sum(v * after, axis=-1))
    along = np.einsum("nmki,ni->nmk", cross, normals)
    return -0.5 * np.sum(np.divide(angle * along, sine, out=np.zeros_like(sine), where=sine > 0), axis=-1)


def cut(polygon, point, normal):
    """What of the polygon lies on the side of a plane that its normal points to."""
    heights = (polygon - point) @ normal
    kept = []
    for i, (a, h) in enumerate(zip(polygon, heights)):
        b, k = polygon[(i + 1) % len(polygon)], heights[(i + 1) % len(polygon)]
        if h >= 0:
            kept.append(a)
        if (h > 0 > k) or (h < 0 < k):
            kept.append(a + (b - a) * (h / (h - k)))
    return np.array(kept).reshape(-1, 3)


def normal_of(polygon):
    n = np.cross(polygon[1] - polygon[0], polygon[2] - polygon[0])
    return n / np.linalg.norm(n)


def area_of(polygon):
    edges = polygon[1:] - polygon[0]
    return 0.5 * np.linalg.norm(np.sum(np.cross(edges[:-1], edges[1:]), axis=0))


def irradiance(receiver, normal, polygon):
    """Of one polygon: 0 from behind, cut at the horizon."""
    if len(polygon) < 3 or np.dot(receiver - polygon[0], normal_of(polygon)) <= 0:
        return 0.0
    above = cut(polygon, receiver, normal)
    return float(unclipped(receiver[None], normal[None], above[None])[0, 0]) if len(above) > 2 else 0.0


def moments(receiver, polygon):
    """Fluence and vector irradiance of a polygon that shows its front (Van Oosterom & Strackee 1983)."""
    vector = unclipped(np.broadcast_to(receiver, (3, 3)), np.eye(3), polygon[None])[:, 0]
    a, *others = (polygon - receiver) / np.linalg.norm(polygon - receiver, axis=1, keepdims=True)
    fluence = sum(2 * np.arctan2(abs(a @ np.cross(b, c)), 1 + a @ b + b @ c + c @ a) for b, c in zip(others, others[1:]))
    return float(fluence), vector


def cap_lookup(fluence, vector, normal):
    """What the server's lookup CAP makes of the moments (MATHS.md 4.3)."""
    length = np.linalg.norm(vector)
    share, along = length / fluence, vector @ normal
    if share < 0.5:
        return max(0.0, fluence / 4 + along / 2)
    cos_a, sin2_a, cos_t = 2 * share - 1, 4 * share * (1 - share), along / length
    if sin2_a < 1e-6 or cos_t ** 2 >= sin2_a:
        return max(0.0, along)
    sin_a = np.sqrt(sin2_a)
    mu = abs(cos_t) / sin_a
    q = np.sqrt(1 - mu * mu)
    part = (np.arctan2(q * sin_a, cos_a) - q * sin_a * cos_a) / sin2_a - abs(cos_t) * np.arctan2(q, mu * cos_a)
    return max(0.0, along) + length * part / np.pi


def through(receiver, polygon, opening):
    """What a receiver sees of a polygon through a convex opening: the polygon cut by the planes through the receiver and
    the opening's edges. The same for what a flat convex thing between the two hides."""
    middle = opening.mean(axis=0)
    for a, b in zip(opening, np.roll(opening, -1, axis=0)):
        side = np.cross(a - receiver, b - receiver)
        if len(polygon) < 3:
            break
        polygon = cut(polygon, receiver, side if np.dot(side, middle - receiver) > 0 else -side)
    return polygon


def seen(receiver, normal, polygon, opening=None, hidden_by=None):
    """Irradiance of a polygon through an opening, less what a convex outline hides of it; both may be None."""
    if opening is not None:
        polygon = through(receiver, polygon, opening)
    whole = irradiance(receiver, normal, polygon)
    return whole - irradiance(receiver, normal, through(receiver, polygon, hidden_by)) if hidden_by is not None else whole


def outline(receiver, corners, axis, depth):
    """Convex outline, on the plane of coordinate `axis` = depth, of a body that lies between it and the receiver."""
    scale = (depth - receiver[axis]) / (corners[:, axis] - receiver[axis])
    shadow = receiver + (corners - receiver) * scale[:, None]
    u, v = (i for i in range(3) if i != axis)
    order = sorted(range(len(shadow)), key=lambda i: (shadow[i, u], shadow[i, v]))
    return shadow[half_hull(shadow, order, u, v)[:-1] + half_hull(shadow, order[::-1], u, v)[:-1]]


def half_hull(points, order, u, v):
    """Indices of the lower hull of points that are ordered along u (Andrew 1979)."""
    kept = []
    for i in order:
        while len(kept) > 1:
            a, b = points[kept[-1]] - points[kept[-2]], points[i] - points[kept[-2]]
            if a[u] * b[v] - a[v] * b[u] > 1e-12:
                break
            kept.pop()
        kept.append(i)
    return kept


def pieces(quad, n):
    """A quadrangle as n x n of them, (n^2, 4, 3)."""
    s = np.linspace(0, 1, n + 1)
    a, b, c, d = quad
    grid = ((1 - s)[:, None, None] * ((1 - s)[:, None] * a + s[:, None] * b)
            + s[:, None, None] * ((1 - s)[:, None] * d + s[:, None] * c))
    return np.stack([grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]], axis=2).reshape(-1, 4, 3)


def reflected(receiver, normal, quad, reflectance, irradiances, n, hidden_by=None):
    """Irradiance from a quadrangle that reflects what it gets, in n x n pieces of one radiance each. `irradiances`: those
    of points (m, 3) of it; `hidden_by`: corners of a convex body before the quadrangle, which is in a plane y = const."""
    quad = cut(quad, receiver, normal)
    if len(quad) != 4 or np.dot(receiver - quad[0], normal_of(quad)) <= 0:
        return 0.0
    parts = pieces(quad, n)
    radiances = reflectance / np.pi * irradiances(parts.mean(axis=1))
    each = unclipped(receiver[None], normal[None], parts)[0]
    if hidden_by is not None:
        dark = outline(receiver, hidden_by, 1, quad[0, 1])
        each -= [irradiance(receiver, normal, through(receiver, part, dark)) for part in parts]
    return float(radiances @ each)


def point_source(receivers, normals, at, intensity):
    """Irradiance of an isotropic point of so many W/sr at receivers (n, 3) that are turned to it."""
    d = np.asarray(at, float) - receivers
    return intensity * np.maximum(np.sum(d * normals, axis=1), 0) / np.sum(d * d, axis=1) ** 1.5


def lambertian_point(receivers, normals, at, axis, intensity):
    """The same of a point that sends `intensity` times the cosine to its axis."""
    d = np.asarray(at, float) - receivers
    cosine = -(d @ np.asarray(axis, float)) / np.linalg.norm(d, axis=1)
    return point_source(receivers, normals, at, intensity) * np.maximum(cosine, 0)


def series(reflectance, bounces):
    """Sum of the powers of the reflectance up to `bounces`: None is all of them."""
    if bounces is None:
        return 1 / (1 - reflectance)
    return float(sum(reflectance ** i for i in range(bounces + 1)))


def bilinear(texels, u, v):
    """A repeated bilinear texture (height, width); (0, 0) is the upper left corner, texels have their values in their
    middles."""
    height, width = texels.shape
    x, y = u * width - 0.5, v * height - 0.5
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    s, t = x - i, y - j
    at = lambda a, b: texels[a % height, b % width]
    return (1 - t) * ((1 - s) * at(j, i) + s * at(j, i + 1)) + t * ((1 - s) * at(j + 1, i) + s * at(j + 1, i + 1))
