#!/usr/bin/python3
"""Makes apps/models/face689.obj of face.obj: a face of 689 vertices, as many as that of the paper's figure 3 has. The skin is
reduced on one side and mirrored; vertices at lids and lips stay. Eyes and teeth are new ones of few vertices. Lips, brows,
cheeks and lashes are a small texture, seen from the front. Needs Debian's python3-numpy.
  usage: tools/faces/reduce.py"""
import heapq
import struct
import zlib
from pathlib import Path

import numpy as np

from decimate import Decimation
from obj import Model, neighbours
from paint import colours, encoded, smooth

MODELS = Path(__file__).parents[2] / "apps/models"
VERTICES = 689
NECK_Y = -11.0 # the bust is cut there
EYE, EYE_RADIUS = np.array([3.114, 3.604, 7.929]), 1.556
# Vertices of face.obj, on the face's own left.
LID_UPPER = [3742, 3747, 3749, 3751, 4190, 3754, 3756, 3758, 3760, 3721]
LID_LOWER = [3742, 3739, 3736, 3734, 3731, 3728, 3726, 3724, 3722, 3721]
NOSE_TIP = 4857
LIP_ROWS_UPPER = [0, 5524, 5527, 5533, 5534] # where they cross the middle, from outside to inside
LIP_ROWS_LOWER = [5518, 5514, 5515, 5519, 5536]
LIP_COLUMNS = [0.6, 1.2, 1.75, 2.2]
LIP_CORNER = [6213, 6155]
# The texture's part of the front: x from -9 to 9, y from -9 to 9.
TEXTURE, HALF_SIDE = 512, 9.0


def shortest_way(vertices, near, begin, end):
    way, before, queue = {begin: 0.0}, {}, [(0.0, begin)]
    while queue:
        length, at = heapq.heappop(queue)
        if at == end:
            break
        for other in near[at]:
            longer = length + np.linalg.norm(vertices[at] - vertices[other])
            if longer < way.get(other, np.inf):
                way[other], before[other] = longer, at
                heapq.heappush(queue, (longer, other))
    way = [end]
    while way[-1] != begin:
        way.append(before[way[-1]])
    return way[::-1]


def along(vertices, near, stations):
    way = [stations[0]]
    for begin, end in zip(stations, stations[1:]):
        way += shortest_way(vertices, near, begin, end)[1:]
    return way


def without_sockets(vertices, triangles, near):
    """Those on the nose's side of the lids' edges: what is behind the edges, eyes hide."""
    edge = along(vertices, near, LID_UPPER) + along(vertices, near, LID_LOWER[::-1])[1:]
    barrier = {frozenset(pair) for pair in zip(edge, edge[1:])}
    sides = {}
    for number, corners in enumerate(triangles):
        for pair in zip(corners, corners[1:] + corners[:1]):
            sides.setdefault(frozenset(pair), []).append(number)
    start = next(number for number, corners in enumerate(triangles) if NOSE_TIP in corners)
    found, queue = {start}, [start]
    while queue:
        corners = triangles[queue.pop()]
        for pair in zip(corners, corners[1:] + corners[:1]):
            for number in sides[frozenset(pair)]:
                if number not in found and frozenset(pair) not in barrier:
                    found.add(number)
                    queue.append(number)
    return [triangles[number] for number in sorted(found)]


def lip_vertices(vertices, near, faces):
    """The vertices at which rows of edges round the mouth cross LIP_COLUMNS."""
    across = {}
    for face in faces:
        for k, corner in enumerate(face):
            across.setdefault(corner, []).append({face[k - 1], face[(k + 1) % len(face)]})
    kept = []
    for first in LIP_ROWS_UPPER + LIP_ROWS_LOWER:
        row = [first, max(near[first], key=lambda vertex: vertices[vertex][0])]
        while len(row) < 22 and len(near[row[-1]]) == 4:
            beside = set().union(*(pair for pair in across[row[-1]] if row[-2] in pair))
            onward = near[row[-1]] - beside
            if len(onward) != 1 or vertices[min(onward)][0] < vertices[row[-1]][0] - 0.05:
                break
            row.append(onward.pop())
        xs = vertices[row, 0]
        kept += [first] + [row[int(np.argmin(np.abs(xs - x)))] for x in LIP_COLUMNS if x < xs.max() + 0.1]
    return kept + LIP_CORNER


def neck_edge(vertices, triangles):
    """The corners of the cut, which is to be level."""
    sides = {}
    for corners in triangles:
        for pair in zip(corners, corners[1:] + corners[:1]):
            sides[frozenset(pair)] = sides.get(frozenset(pair), 0) + 1
    cut = [list(side) for side, count in sides.items() if count == 1 and (vertices[list(side), 0] > 1e-6).any()]
    return [corner for side in cut for corner in side if vertices[corner, 1] < NECK_Y + 1.5]


def importance(place):
    x, y, z = place.T
    weight = np.full(len(place), 0.12)
    weight = np.maximum(weight, 0.7 * smooth(2.0, 7.0, z) * smooth(-10.0, -8.0, y))
    weight = np.maximum(weight, 0.08 * (x > 6.8) * (np.abs(y - 2.0) < 4.5)) # ears
    for at, radius, most in (((0, -3.4, 11), 2.6, 3.0), ((3.1, 3.6, 9.3), 2.2, 3.0), ((0, 0.3, 12), 2.4, 2.2),
                             ((3.0, 6.0, 10.2), 1.6, 1.0)):
        near = np.linalg.norm((place - at) / [1.0, 1.0, 1.6], axis=1)
        weight = np.maximum(weight, most * smooth(1.2 * radius, 0.6 * radius, near))
    inside = (np.abs(x) < 2.6) & (y < -2.6) & (y > -4.4) & (z < 10.9) & (np.hypot(x, y + 3.4) < 2.2)
    return np.where(inside, 0.02, weight)


class Skin:
    """The skin's half with x >= 0, reduced."""

    def __init__(self, model, count):
        self.vertices = model.vertices.copy()
        quads = model.faces["M_Face"] + model.faces["M_BackHead"]
        near = neighbours(quads)
        half = [face for face in quads
                if (self.vertices[face, 0] > -1e-6).all() and (self.vertices[face, 1] > NECK_Y).all()]
        triangles = []
        for a, b, c, d in half:
            shorter = np.linalg.norm(np.diff(self.vertices[[[a, c], [b, d]]], axis=1), axis=2).argmin()
            triangles += [[a, b, c], [a, c, d]] if shorter == 0 else [[a, b, d], [b, c, d]]
        triangles = without_sockets(self.vertices, triangles, near)
        self.vertices[neck_edge(self.vertices, triangles), 1] = NECK_Y
        kept = LID_UPPER + LID_LOWER + lip_vertices(self.vertices, near, model.faces["M_Face"])
        reduction = Decimation(self.vertices, triangles, importance(self.vertices), kept)
        self.triangles = reduction.run(count, lambda vertex: 2 if self.vertices[vertex, 0] > 1e-6 else 1)

    def whole(self):
        """Vertices and triangles of both sides; those in the middle first."""
        used = sorted({corner for corners in self.triangles for corner in corners},
                      key=lambda vertex: (self.vertices[vertex, 0] > 1e-6, vertex))
        middle = sum(1 for vertex in used if self.vertices[vertex, 0] < 1e-6)
        left = {vertex: number for number, vertex in enumerate(used)}
        right = {vertex: number if number < middle else number + len(used) - middle for vertex, number in left.items()}
        places = self.vertices[used]
        places = np.vstack([places, places[middle:] * [-1, 1, 1]])
        triangles = [[left[c] for c in corners] for corners in self.triangles]
        triangles += [[right[c] for c in corners[::-1]] for corners in self.triangles]
        return places, triangles


def eye(side):
    """Rings about the way of looking: pupil, iris, white."""
    rings = [(0.14, 8), (0.40, 12), (0.78, 10), (1.25, 9)]
    places, faces = [[0.0, 0.0, 1.0]], {"Pupil": [], "Iris": [], "Sclera": []}
    before, first = [0], 1
    for (angle, count), name in zip(rings, ["Pupil", "Iris", "Sclera", "Sclera"]):
        turn = 2 * np.pi * np.arange(count) / count
        places += np.c_[np.sin(angle) * np.cos(turn), np.sin(angle) * np.sin(turn), np.full(count, np.cos(angle))].tolist()
        ring = list(range(first, first + count))
        faces[name] += between(before, ring)
        before, first = ring, first + count
    outwards = 0.05
    turned = np.array(places) @ np.array([[np.cos(outwards), 0, -np.sin(outwards)], [0, 1, 0],
                                          [np.sin(outwards), 0, np.cos(outwards)]])
    places = np.round(EYE + EYE_RADIUS * turned, 5)
    if side == "Right":
        places, faces = places * [-1, 1, 1], {name: [f[::-1] for f in own] for name, own in faces.items()}
    return places, faces


def between(inner, outer):
    """Triangles between two rings, or between a point and a ring."""
    faces, a, b = [], 0, 0
    n, m = (len(inner) if len(inner) > 1 else 0), len(outer)
    while a < n or b < m:
        if b < m and (a >= n or (b + 1) / m <= (a + 1) / n):
            faces.append([inner[a % len(inner)], outer[b % m], outer[(b + 1) % m]])
            b += 1
        else:
            faces.append([inner[a % n], outer[b % m], inner[(a + 1) % n]])
            a += 1
    return faces


def teeth(high, low, behind):
    xs = np.array([-2.3, -1.8, -1.2, -0.6, 0, 0.6, 1.2, 1.8, 2.3])
    z = np.interp(np.abs(xs), [0, 0.6, 1.2, 1.8, 2.3], [10.62, 10.48, 10.28, 9.9, 9.1]) - behind
    places = np.vstack([np.c_[xs, np.full(9, high), z], np.c_[xs, np.full(9, low), z]])
    return places, [[k + 9, k + 10, k + 1, k] for k in range(8)]


def png(path, pixels):
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    chunks = ((b"IHDR", struct.pack(">IIBBBBB", pixels.shape[1], pixels.shape[0], 8, 2, 0, 0, 0)),
              (b"IDAT", zlib.compress(rows, 9)), (b"IEND", b""))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in chunks))


def texture(model):
    """What multiplies the skin's colour, seen from the front."""
    middle = (np.arange(TEXTURE) + 0.5) / TEXTURE * 2 * HALF_SIDE - HALF_SIDE
    x, y = (grid.ravel() for grid in np.meshgrid(middle, -middle))
    paint = colours(np.c_[x, y, np.full(len(x), 11.0)])
    for lid, width, strength in ((LID_UPPER, 0.14, 0.95), (LID_LOWER, 0.06, 0.5)):
        line = model.vertices[lid][:, :2]
        off = np.full(len(x), np.inf)
        for a, b in zip(line, line[1:]):
            part = np.clip(((np.abs(x) - a[0]) * (b - a)[0] + (y - a[1]) * (b - a)[1]) / (b - a).dot(b - a), 0, 1)
            off = np.minimum(off, np.hypot(np.abs(x) - a[0] - part * (b - a)[0], y - a[1] - part * (b - a)[1]))
        ink = strength * smooth(width, 0.4 * width, off)[:, None]
        paint = paint * (1 - ink) + ink * [0.03, 0.018, 0.012]
    return np.uint8(np.round(255 * encoded(paint))).reshape(TEXTURE, TEXTURE, 3)


def material_of(places, corners):
    middle = places[corners].mean(0)
    if middle[2] < 10.75 and abs(middle[0]) < 2.2 and -5.0 < middle[1] < -2.0 and middle[2] > 5.0:
        return "Mouth" if np.hypot(middle[0], middle[1] + 3.4) < 2.15 and middle[2] < 10.75 - 0.35 * abs(middle[0]) else "Face"
    return "Face" if places[corners, 2].max() > 5.0 else "Head"


def main():
    model = Model(MODELS / "face.obj")
    parts = [eye("Left"), eye("Right"), *[(p, {"Teeth": f}) for p, f in (teeth(-2.55, -3.72, 0), teeth(-3.5, -4.25, 0.2))]]
    places, triangles = Skin(model, VERTICES - sum(len(part[0]) for part in parts)).whole()
    faces = {}
    for corners in triangles:
        faces.setdefault(material_of(places, corners), []).append(corners)
    for own, groups in parts:
        for name, group in groups.items():
            faces.setdefault(name, []).extend([[c + len(places) for c in face] for face in group])
        places = np.vstack([places, own])
    header = [line for line in model.lines if line.startswith("##") or (line.startswith("# ") and line.endswith("#"))]
    lines = header + ["", "# Reduced from face.obj by tools/faces/reduce.py.", "mtllib face689.mtl"]
    lines += ["v {:g} {:g} {:g}".format(*place) for place in places]
    lines += ["vt {:.4g} {:.4g}".format(*np.clip((place[:2] + HALF_SIDE) / (2 * HALF_SIDE), 0, 1)) for place in places]
    for name in sorted(faces):
        lines += [f"usemtl {name}"] + ["f " + " ".join(f"{c + 1}/{c + 1}" for c in face) for face in faces[name]]
    (MODELS / "face689.obj").write_text("\n".join(lines) + "\n")
    png(MODELS / "face689.png", texture(model))
    print(len(places), "vertices,", sum(len(face) - 2 for group in faces.values() for face in group), "triangles")


if __name__ == "__main__":
    main()
