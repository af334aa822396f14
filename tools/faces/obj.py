"""Wavefront OBJ as far as the shipped faces need it: vertices, and faces by their material."""
import numpy as np


class Model:
    """vertices: n by 3. faces: lists of corners, counted from 0, by the name of their material."""

    def __init__(self, path):
        self.lines = open(path).read().split("\n")
        rows, self.faces, group = [], {}, None
        for line in self.lines:
            words = line.split()
            if not words:
                continue
            if words[0] == "v":
                rows.append([float(word) for word in words[1:4]])
            elif words[0] == "usemtl":
                group = self.faces.setdefault(words[1], [])
            elif words[0] == "f":
                group.append([int(word.split("/")[0]) - 1 for word in words[1:]])
        self.vertices = np.array(rows)

    def of_material(self, name):
        """The numbers of the vertices that a material's faces have, rising."""
        return np.unique(np.concatenate(self.faces[name]))

    def twins(self):
        """The vertex on the other side of x = 0, by vertex: the nearest to its mirror image in the same material."""
        twin = np.full(len(self.vertices), -1)
        for name in self.faces:
            other = name.replace("Left", "@").replace("Right", "Left").replace("@", "Right")
            ours, theirs = self.of_material(name), self.of_material(other)
            for vertex in ours[twin[ours] < 0]:
                apart = self.vertices[theirs] - self.vertices[vertex] * [-1, 1, 1]
                twin[vertex] = theirs[np.argmin((apart**2).sum(1))]
        return twin


def edges_of(faces):
    """Pairs of corners, the smaller first."""
    return {(min(a, b), max(a, b)) for face in faces for a, b in zip(face, face[1:] + face[:1])}


def neighbours(faces):
    near = {}
    for a, b in edges_of(faces):
        near.setdefault(a, set()).add(b)
        near.setdefault(b, set()).add(a)
    return near
