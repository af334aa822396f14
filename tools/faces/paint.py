#!/usr/bin/python3
"""Paints apps/models/face.obj by colours of vertices: lips, brows and a little red in the cheeks. It also makes the vertices
symmetric to x = 0, which those of ICT FaceKit are but for some 0.05 mm. Needs Debian's python3-numpy.
  usage: tools/faces/paint.py [face.obj]
What is there already is painted over, so it can run again."""
import sys
from pathlib import Path

import numpy as np

from obj import Model

# Places in centimetres, on the face's own left; colours as parts of the skin's, linear.
LIP_UPPER = [(0, -2.52), (0.55, -2.45), (1.05, -2.52), (1.6, -2.78), (2.15, -3.12), (2.5, -3.46)]
LIP_LOWER = [(0, -4.40), (0.6, -4.40), (1.1, -4.32), (1.6, -4.12), (2.1, -3.80), (2.5, -3.52)]
BROW = [(1.25, 5.72), (2.2, 6.12), (3.3, 6.42), (4.4, 6.3), (5.5, 5.75)]
BROW_HALF_WIDTH = [0.42, 0.44, 0.38, 0.30, 0.12]
CHEEK = ((4.1, -0.4), 2.1)
LIP_COLOUR = np.array([0.82, 0.50, 0.55])
BROW_COLOUR = np.array([0.22, 0.20, 0.18])
CHEEK_COLOUR = np.array([1.0, 0.84, 0.84])


def smooth(low, high, value):
    part = np.clip((value - low) / (high - low), 0, 1)
    return part * part * (3 - 2 * part)


def lip_part(x, y, z):
    """1 inside the lips, 0 outside, and between over some 1.5 mm at their edge."""
    upper = np.interp(x, *zip(*LIP_UPPER))
    lower = np.interp(x, *zip(*LIP_LOWER))
    inside = np.minimum(upper - y, y - lower)
    return smooth(-0.09, 0.06, inside) * smooth(2.66, 2.5, x) * smooth(9.5, 10.0, z)


def brow_part(x, y, z):
    line = np.interp(x, *zip(*BROW))
    half = np.interp(x, [place[0] for place in BROW], BROW_HALF_WIDTH)
    ends = smooth(BROW[0][0] - 0.35, BROW[0][0] + 0.3, x) * smooth(BROW[-1][0] + 0.3, BROW[-1][0] - 0.3, x)
    return smooth(1.25, 0.5, np.abs(y - line) / half) * ends * smooth(5.0, 6.0, z)


def cheek_part(x, y, z):
    (at_x, at_y), radius = CHEEK
    return smooth(1.0, 0.0, np.hypot(x - at_x, y - at_y) / radius) * smooth(5.0, 7.0, z)


def colours(vertices):
    """Linear colours that multiply the skin's."""
    place = (np.abs(vertices[:, 0]), vertices[:, 1], vertices[:, 2])
    paint = np.ones((len(vertices), 3))
    for part, colour in ((cheek_part, CHEEK_COLOUR), (lip_part, LIP_COLOUR), (brow_part, BROW_COLOUR)):
        weight = part(*place)[:, None]
        paint = paint * (1 - weight) + paint * colour * weight
    return paint


def encoded(linear):
    """sRGB, as OBJ's colours are."""
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)


def symmetric(model):
    """Vertices of which each is its twin's mirror image. Who is not its twin's twin stays."""
    vertices, twin = model.vertices.copy(), model.twins()
    paired = twin[twin] == np.arange(len(twin))
    middle = 0.5 * (vertices + vertices[twin] * [-1, 1, 1])
    middle[twin == np.arange(len(twin)), 0] = 0
    left = paired & (vertices[:, 0] >= 0)
    vertices[left] = np.round(middle[left], 5)
    vertices[twin[left]] = vertices[left] * [-1, 1, 1]
    vertices[vertices == 0] = 0 # no minus before a zero
    return vertices


def main():
    path = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parents[2] / "apps/models/face.obj")
    model = Model(path)
    vertices = symmetric(model)
    print(f"moved by at most {np.abs(vertices - model.vertices).max():.4f}")
    paint = np.ones_like(vertices)
    skin = model.of_material("M_Face")
    paint[skin] = np.round(encoded(colours(vertices[skin])), 3)
    at, lines = 0, []
    for line in model.lines:
        if line.startswith("v "):
            colour = "" if (paint[at] > 0.99).all() else " {:g} {:g} {:g}".format(*paint[at])
            line = "v {:g} {:g} {:g}".format(*vertices[at]) + colour
            at += 1
        lines.append(line)
    path.write_text("\n".join(lines))


if __name__ == "__main__":
    main()
