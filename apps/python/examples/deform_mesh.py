"""Pulls the highest point of a model upwards, without a glove.
   deform_mesh.py MODEL OUT    .obj, .ply or .stl"""
import sys

import nendo

mesh = nendo.Mesh.read(sys.argv[1])
top = mesh.vertices[[mesh.vertices[:, 1].argmax()]]
shape = nendo.deform(mesh.vertices, top, top + [0, 0.1 * mesh.diagonal, 0], radius=0.3 * mesh.diagonal)
mesh.with_vertices(shape).write(sys.argv[2])
print(f"{mesh}: {(shape != mesh.vertices).any(axis=1).sum()} vertices moved")
