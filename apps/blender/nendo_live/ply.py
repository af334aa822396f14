"""Writes a mesh as a binary PLY file, with the order of its vertices and polygons. Needs nothing of Blender."""
import os

import numpy as np


def write(path, vertices, face_sizes, corners):
    """Vertices (n, 3); the number of corners of each face; and the corners of all faces, one after another. Writes another file and
    renames it, so that no program reads half of one. Raises OSError."""
    sizes = np.asarray(face_sizes, np.int64)
    if sizes.size and (sizes.min() < 3 or sizes.max() > 255):
        raise ValueError("a polygon has more than 255 corners")
    head = ("ply\nformat binary_little_endian 1.0\n"
            f"element vertex {len(vertices)}\nproperty double x\nproperty double y\nproperty double z\n"
            f"element face {len(sizes)}\nproperty list uchar int vertex_indices\nend_header\n")
    part = f"{path}.part"
    with open(part, "wb") as file:
        file.write(head.encode())
        file.write(np.ascontiguousarray(vertices, "<f8").tobytes())
        file.write(_faces(sizes, np.asarray(corners, "<i4")).tobytes())
    os.replace(part, path)


def _faces(sizes, corners):
    """Each face is a byte with its size, and four bytes for each corner."""
    starts = np.cumsum(1 + 4 * sizes) - (1 + 4 * sizes)
    out = np.zeros(int((1 + 4 * sizes).sum()), np.uint8)
    out[starts] = sizes
    is_corner = np.ones(len(out), bool)
    is_corner[starts] = False
    out[is_corner] = corners.view(np.uint8)
    return out
