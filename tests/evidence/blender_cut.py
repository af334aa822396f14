# Times Blender's exact Boolean for one plane through the ball of `nendo bench cut`, both halves, by
# Blender's own processor time: blender -b --factory-startup --python tests/evidence/blender_cut.py
import math
import time

import bmesh
import bpy
from mathutils import Vector

POINT, NORMAL = Vector((0.1, 0.05, 0.02)), Vector((0.3, 0.5, 0.8)).normalized()


def ball(rings, segments):
    places = [(0, 0, 1), (0, 0, -1)]
    for ring in range(rings):
        for segment in range(segments):
            polar, turn = math.pi * (ring + 1) / (rings + 1), 2 * math.pi * segment / segments
            x, y, z = math.sin(polar) * math.cos(turn), math.sin(polar) * math.sin(turn), math.cos(polar)
            bump = 1 + 0.1 * math.sin(7 * x) * math.sin(9 * y + 1)
            places.append((x * bump, y * bump, z * bump))
    faces, last = [], 2 + (rings - 1) * segments
    for at in range(segments):
        beside = (at + 1) % segments
        faces.append((0, 2 + at, 2 + beside))
        for start in range(2, last, segments):
            faces.append((start + at, start + segments + at, start + segments + beside))
            faces.append((start + at, start + segments + beside, start + beside))
        faces.append((last + at, 1, last + beside))
    mesh = bpy.data.meshes.new("ball")
    mesh.from_pydata(places, [], faces)
    thing = bpy.data.objects.new("ball", mesh)
    bpy.context.collection.objects.link(thing)
    return thing


def half_space():
    bpy.ops.mesh.primitive_cube_add(size=20, location=POINT + 10 * NORMAL,
                                    rotation=NORMAL.to_track_quat("Z", "Y").to_euler())
    return bpy.context.object


def volume_after(thing, box, operation):
    modifier = thing.modifiers.new("cut", "BOOLEAN")
    modifier.operation, modifier.solver, modifier.object = operation, "EXACT", box
    begin = time.process_time()
    made = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = made.to_mesh()
    spent = time.process_time() - begin
    work = bmesh.new()
    work.from_mesh(mesh)
    volume = work.calc_volume()
    work.free()
    made.to_mesh_clear()
    thing.modifiers.clear()
    return spent, volume


box = half_space()
for rings in (87, 287):
    thing = ball(rings, 2 * rings)
    runs = [volume_after(thing, box, operation) for operation in ("DIFFERENCE", "INTERSECT")]
    print(f"{len(thing.data.polygons)} triangles: both halves {1e3 * sum(run[0] for run in runs):.0f} ms, "
          f"volumes {runs[0][1]:.9f} + {runs[1][1]:.9f} = {runs[0][1] + runs[1][1]:.9f}")
    bpy.data.objects.remove(thing)
