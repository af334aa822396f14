"""A mesh of the scene goes out to a run of nendo, and its shape comes back, with the same order of vertices."""
import itertools
import os

import bpy
import numpy as np
from mathutils import Matrix, Vector

from . import mapping, ply, process, scene

_counter = itertools.count(1)


class CannotShape(Exception):
    """The message is one line for the user."""


class Shaping:
    """A run that shapes the object `source`. Raises CannotShape, OSError, ValueError."""

    def __init__(self, source, program, options):
        if source is None or source.type != "MESH":
            raise CannotShape("Select a mesh first")
        if source.mode != "OBJECT":
            raise CannotShape("Leave edit mode first")
        if len(source.data.polygons) == 0:
            raise CannotShape(f"{source.name} has no faces")
        self._turn = np.array(source.matrix_world.to_3x3(), float)
        if abs(np.linalg.det(self._turn)) < 1e-12:
            raise CannotShape(f"{source.name} has a scale of 0")
        self.name = f"blender-{os.getpid()}-{next(_counter)}"
        self.source, self._location = source.name, source.matrix_world.translation.copy()
        self._vertices, self._triangles = len(source.data.vertices), None
        self._keeps_hidden = False
        self.run = process.Run(lambda folder: self._command(source.data, folder, program, options))
        source.hide_set(True)

    def _command(self, mesh, folder, program, options):
        points = np.empty(3 * len(mesh.vertices), np.float32)
        basis = mesh.shape_keys.reference_key.data if mesh.shape_keys else mesh.vertices
        basis.foreach_get("co", points)
        sizes, corners = np.empty(len(mesh.polygons), np.int32), np.empty(len(mesh.loops), np.int32)
        mesh.polygons.foreach_get("loop_total", sizes)
        mesh.loops.foreach_get("vertex_index", corners)
        if np.linalg.det(self._turn) < 0.0:  # a mirrored object: its faces face outwards only if they are reversed
            sizes, corners = sizes[::-1], corners[::-1].copy()
        path = os.path.join(folder, "model.ply")
        ply.write(path, mapping.to_stage(points.reshape(-1, 3).astype(float) @ self._turn.T), sizes, corners)
        return process.command(program, path, self.name, os.path.join(folder, "shaped.ply"), options)

    def object(self):
        """The object that went out. Raises CannotShape."""
        source = bpy.data.objects.get(self.source)
        if source is None or source.type != "MESH":
            raise CannotShape(f"{self.source} is gone, or has another name")
        return source

    def placement(self, content, frame):
        """Of the stage: the shape is then where the object was."""
        if self._triangles is None:
            self._triangles = content.triangles
        offset = Vector(mapping.to_blender(content.setup.offset))
        return Matrix.Translation(self._location + offset) @ Matrix.Scale(frame.units_per_metre, 4)

    def template(self):
        """The mesh that went out, or None."""
        source = bpy.data.objects.get(self.source)
        return source.data if source is not None and source.type == "MESH" else None

    def _points(self, link):
        """(n, 3) float32 in the object's coordinates."""
        frame, floats = link.current()
        if frame is None:
            raise CannotShape("There is no shape yet")
        points = mapping.to_blender(mapping.model_points(floats, link.content.setup)) @ np.linalg.inv(self._turn).T
        return points.astype(np.float32)

    def _has_same_vertices(self, link):
        return link.content.vertices == self._vertices and np.array_equal(link.content.triangles, self._triangles)

    def bring_back_as_key(self, link):
        """Adds a shape key with a value of 1; returns its name."""
        source = self.object()
        if not self._has_same_vertices(link) or len(source.data.vertices) != self._vertices:
            raise CannotShape("The model has other vertices than before: bring it back as a mesh")
        points = self._points(link)
        if source.data.shape_keys is None:
            source.shape_key_add(name="Basis", from_mix=False)
        key = source.shape_key_add(name="Nendo", from_mix=False)
        key.data.foreach_set("co", points.ravel())
        key.value = 1.0
        source.active_shape_key_index = len(source.data.shape_keys.key_blocks) - 1
        source.data.update()
        return key.name

    def bring_back_as_mesh(self, link):
        """Makes another object with the source's transform and materials; returns it."""
        source = self.object()
        points = self._points(link)
        shaped = source.copy()
        shaped.name = f"{source.name} shaped"
        if shaped.data is not None:
            shaped.data = source.data.copy()
        if shaped.data.shape_keys:
            shaped.shape_key_clear()
        if self._has_same_vertices(link) and len(source.data.vertices) == self._vertices:
            shaped.data.vertices.foreach_set("co", points.ravel())
            shaped.data.update()
        else:
            triangles = link.content.triangles
            if np.linalg.det(self._turn) < 0.0:
                triangles = triangles[:, ::-1]
            scene.set_geometry(shaped.data, points, np.full(len(triangles), 3), triangles)
        for collection in source.users_collection:
            collection.objects.link(shaped)
        shaped.hide_set(False)
        self._keeps_hidden = True
        return shaped

    def end(self):
        """Ends the run, and shows the object again, unless a shaped one is in its place. Does not wait."""
        self.run.end()
        source = bpy.data.objects.get(self.source)
        if source is not None and not self._keeps_hidden and bpy.context.view_layer.objects.get(source.name) is not None:
            source.hide_set(False)
