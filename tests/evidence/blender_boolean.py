# Times Blender's exact Boolean, by Blender's own processor time: one plane through the ball of `nendo
# bench cut`, both halves, and the union of the balls of `nendo bench join`.
#   blender -b --factory-startup --python tests/evidence/blender_boolean.py
import math
import time

import bmesh
import bpy
from mathutils import Vector

POINT, NORMAL = Vector((0.1, 0.05, 0.02)), Vector((0.3, 0.5, 0.8)).normalized()


def ball(rings, middle=0.0, is_bumpy=True):
    segments = 2 * rings
    places = [(middle, 0, 1), (middle, 0, -1)]
    for ring in range(rings):
        for segment in range(segments):
            polar, turn = math.pi * (ring + 1) / (rings + 1), 2 * math.pi * segment / segments
            x, y, z = math.sin(polar) * math.cos(turn), math.sin(polar) * math.sin(turn), math.cos(polar)
            bump = 1 + 0.1 * math.sin(7 * x) * math.sin(9 * y + 1) if is_bumpy else 1
            places.append((middle + x * bump, y * bump, z * bump))
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


def volume_after(thing, other, operation):
    modifier = thing.modifiers.new("boolean", "BOOLEAN")
    modifier.operation, modifier.solver, modifier.object = operation, "EXACT", other
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
    thing = ball(rings)
    runs = [volume_after(thing, box, operation) for operation in ("DIFFERENCE", "INTERSECT")]
    print(f"{len(thing.data.polygons)} triangles: both halves {1e3 * sum(run[0] for run in runs):.0f} ms, "
          f"volumes {runs[0][1]:.9f} + {runs[1][1]:.9f} = {runs[0][1] + runs[1][1]:.9f}")
    bpy.data.objects.remove(thing)
bpy.data.objects.remove(box)
for rings in (40, 87, 160):
    one, other = ball(rings, 0.0, False), ball(rings, 1.0, False)
    runs = [volume_after(one, other, "UNION") for _ in range(3)]
    exact = 8 / 3 * math.pi - 5 / 12 * math.pi
    print(f"2 x {len(one.data.polygons)} triangles: union {1e3 * min(run[0] for run in runs):.0f} ms, "
          f"volume off by {abs(runs[0][1] - exact) / exact:.1e}")
    for thing in (one, other):
        bpy.data.objects.remove(thing)
