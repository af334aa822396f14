"""Tests of the add-on inside of Blender, without a screen, against runs of nendo. See tools/check-blender, which calls:
blender --background --factory-startup --python judge.py -- NENDO MODELS ZIP WORK"""
import csv
import importlib
import os
import signal
import statistics
import struct
import subprocess
import sys
import time
import unittest

import bpy
import numpy as np
from mathutils import Euler, Matrix, Quaternion, Vector

NENDO, MODELS, ZIP, WORK = map(os.path.abspath, sys.argv[sys.argv.index("--") + 1:])
MODULE = "nendo_live"
NEAR_M, NEAR_RAD, NEAR = 1e-5, 1e-4, 1e-6  # the last one of the model's diagonal
SECOND = 1.0


def report(line):
    print(f"\nnendo: {line}", flush=True)


def install():
    """As a user installs the zip. Returns the name under which Blender has it."""
    if bpy.app.version < (4, 2):
        bpy.ops.preferences.addon_install(filepath=ZIP)
        bpy.ops.preferences.addon_enable(module=MODULE)
        return MODULE
    bpy.ops.extensions.package_install_files(filepath=ZIP, repo="user_default", enable_on_install=True)
    return f"bl_ext.user_default.{MODULE}"


def part(name):
    return importlib.import_module(f"{INSTALLED}.{name}")


class Run:
    """A run of nendo that publishes. `name` is that of its segment."""

    count = 0

    def __init__(self, *words, name=None, gloves=("sim:sculpt?seed=7", "sim:sculpt?seed=8")):
        Run.count += 1
        self.name = name or f"judge-{os.getpid()}-{Run.count}"
        self.log = os.path.join(WORK, f"{self.name}-{Run.count}.log")
        self.out = os.path.join(WORK, f"{self.name}-{Run.count}.ply")
        with open(self.log, "wb") as log:
            self.process = subprocess.Popen(
                [NENDO, "run", "--left", gloves[0], "--right", gloves[1], "--to", f"shm:{self.name}", "--out", self.out, "--force",
                 *words], stdin=subprocess.DEVNULL, stdout=log, stderr=log)

    def end(self, how=signal.SIGINT):
        if self.process.poll() is None:
            self.process.send_signal(how)
        return self.process.wait(timeout=60)


def nendo(*words):
    return subprocess.run([NENDO, *words], check=True, stdin=subprocess.DEVNULL, capture_output=True, text=True).stdout


def read_ply(path):
    """The vertices of a binary PLY as nendo writes it."""
    with open(path, "rb") as file:
        head, _, body = file.read().partition(b"end_header\n")
    words = [line.split() for line in head.decode().splitlines()]
    count = next(int(each[2]) for each in words if each[:2] == ["element", "vertex"])
    kind = next(each[1] for each in words if each[0] == "property")
    return np.frombuffer(body, {"double": "<f8", "float": "<f4"}[kind], 3 * count).reshape(-1, 3).astype(float)


def ball(rings, corners):
    """A closed surface of quads and two fans: vertices and faces."""
    polar, around = np.pi * np.arange(1, rings) / rings, 2 * np.pi * np.arange(corners) / corners
    grid = [(np.sin(p) * np.sin(a), np.cos(p), np.sin(p) * np.cos(a)) for p in polar for a in around]
    faces = [(r * corners + k, (r + 1) * corners + k, (r + 1) * corners + (k + 1) % corners, r * corners + (k + 1) % corners)
             for r in range(rings - 2) for k in range(corners)]
    top, bottom = len(grid), len(grid) + 1
    faces += [(top, k, (k + 1) % corners) for k in range(corners)]
    faces += [(bottom, (rings - 2) * corners + (k + 1) % corners, (rings - 2) * corners + k) for k in range(corners)]
    return np.array(grid + [(0, 1, 0), (0, -1, 0)]), faces


def world_vertices(thing):
    """(n, 3), of the evaluated object."""
    graph = bpy.context.evaluated_depsgraph_get()
    shown = thing.evaluated_get(graph)
    mesh = shown.to_mesh()
    places = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", places)
    shown.to_mesh_clear()
    matrix = np.array(shown.matrix_world)
    return places.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]


def bones(rig):
    """The pose of each bone in the world, by name."""
    shown = rig.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return {bone.name: shown.matrix_world @ bone.matrix for bone in shown.pose.bones}


def wanted_bones(joints, suffix):
    """The same by quaternions: Blender's importer of glTF turns y up into z up by a quarter turn about x."""
    quarter = Quaternion((1, 0, 0), np.pi / 2)
    names = part("mapping").JOINT_NAMES
    return {name + suffix: (quarter @ Vector(joint[:3]), quarter @ Quaternion(joint[[6, 3, 4, 5]]) @ quarter.inverted())
            for name, joint in zip(names, joints.astype(float))}


def joints_in_segment(name, number):
    """(2, 26, 7): read by the offsets of FORMAT.md."""
    with open(f"/dev/shm/nendo-{name}", "rb") as file:
        head = file.read(192)
        slots, = struct.unpack_from("=I", head, 36)
        first, stride = struct.unpack_from("=2Q", head, 72)
        file.seek(first + number % slots * stride)
        record = file.read(1616)
    assert struct.unpack_from("=2Q", record) == (2 * number + 2, number)
    return np.stack([np.frombuffer(record, "=f4", 182, at).reshape(26, 7) for at in (144, 888)])


def diagonal(points):
    return float(np.linalg.norm(points.max(axis=0) - points.min(axis=0)))


class TestCase(unittest.TestCase):
    def setUp(self):
        self.live = part("live").live
        self.addCleanup(self.clear)

    def clear(self):
        self.live.disconnect()
        if bpy.context.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        for kind in (bpy.data.objects, bpy.data.collections, bpy.data.meshes, bpy.data.armatures, bpy.data.actions,
                     bpy.data.materials):
            for each in list(kind):
                kind.remove(each)

    def run_nendo(self, *words, **options):
        run = Run(*words, **options)
        self.addCleanup(run.end, signal.SIGKILL)
        return run

    def step_until(self, condition, what, seconds=120.0):
        end = time.monotonic() + seconds
        while not condition():
            self.assertLess(time.monotonic(), end, f"{what}: {self.live.message}")
            self.live.step()
            self.assertNotIn("error", self.live.message)
            time.sleep(0.005)

    def connect(self, run):
        bpy.ops.nendo.connect(name=run.name)
        self.step_until(lambda: self.live.frame is not None and self.live.objects.find("model") is not None, "the first tick")

    def step_for(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.live.step()
            self.assertNotIn("error", self.live.message)
            time.sleep(0.01)

    def rig(self, side):
        return self.live.objects.find(("left", "right")[side])

    def assert_hand(self, rig, joints, side, name):
        wanted, found = wanted_bones(joints, ("_L", "_R")[side]), bones(rig)
        self.assertEqual(set(found), set(wanted))
        for bone, (place, turn) in wanted.items():
            self.assertLess((found[bone].to_translation() - place).length, NEAR_M, f"{name} {bone}")
            angle = found[bone].to_quaternion().rotation_difference(turn).angle
            self.assertLess(min(angle, abs(2 * np.pi - angle)), NEAR_RAD, f"{name} {bone}")


class Following(TestCase):
    def test_model_and_hands_are_those_of_the_run(self):
        take = os.path.join(WORK, "followed.nendo")
        run = self.run_nendo("--mesh", os.path.join(MODELS, "moai.obj"), "--record", take)
        self.connect(run)
        kept = []
        for at in range(200):
            self.live.step()
            frame = self.live.frame
            if at % 40 == 20:
                joints = joints_in_segment(run.name, frame.number)
                for side in (0, 1):
                    self.assert_hand(self.rig(side), joints[side], side, f"tick {frame.number}")
                kept.append((frame, joints, world_vertices(self.live.objects.find("model"))))
            time.sleep(0.008)
        left, right = (bones(self.rig(side))["wrist" + suffix].to_translation() for side, suffix in ((0, "_L"), (1, "_R")))
        self.assertLess(left.x, right.x)
        self.assertGreater(self.live.link.rate_hz, 10.0)
        self.assertEqual(run.end(), 0)
        self.compare_with_replay(take, kept)

    def compare_with_replay(self, take, kept):
        """The replayed loop's own shapes and fingertips: nothing of the publisher's is in these."""
        table = os.path.join(WORK, "followed.csv")
        nendo("export", take, "--out", table)
        with open(table, newline="") as file:
            rows = list(csv.DictReader(file))
        farthest = tips = 0.0
        for frame, joints, found in kept:
            row = rows[frame.number - 1]
            for side, hand in enumerate(("left", "right")):
                for finger, joint in (("thumb", 5), ("index", 10), ("little", 25)):
                    wanted = [float(row[f"{hand}_{finger}_tip_{axis}_m"]) for axis in "xyz"]
                    tips = max(tips, float(np.abs(joints[side, joint, :3] - wanted).max()))
            shape = os.path.join(WORK, f"replayed-{frame.number}.ply")
            nendo("replay", take, "--to", f"{float(row['time_s']) + 2e-5:.6f}", "--no-clock", "--out", shape)
            wanted = read_ply(shape) / frame.units_per_metre
            wanted = np.stack([wanted[:, 0], -wanted[:, 2], wanted[:, 1]], axis=1)
            farthest = max(farthest, float(np.linalg.norm(found - wanted, axis=1).max()) / diagonal(wanted))
        report(f"vertices against nendo replay: {farthest:.1e} of the diagonal; fingertips against its table: {tips:.1e} m")
        self.assertLess(farthest, NEAR)
        self.assertLess(tips, NEAR_M)

    def test_a_run_starts_again_with_another_model(self):
        run = self.run_nendo("--mesh", os.path.join(MODELS, "moai.obj"))
        self.connect(run)
        model = self.live.objects.find("model").name
        before = len(bpy.data.objects[model].data.vertices)
        self.assertEqual(run.end(), 0)
        self.step_until(lambda: "has ended" in self.live.message, "the end")
        again = self.run_nendo("--mesh", os.path.join(MODELS, "spot.obj"), name=run.name)
        self.step_until(lambda: len(bpy.data.objects[model].data.vertices) != before, "the next run")
        self.step_for(0.3)
        mesh = bpy.data.objects[model].data
        self.assertFalse(mesh.validate())
        self.assertEqual((len(mesh.vertices), len(mesh.polygons)),
                         (self.live.link.content.vertices, len(self.live.link.content.triangles)))
        self.assertLess(diagonal(world_vertices(bpy.data.objects[model])), 3.0)
        again.end(signal.SIGKILL)
        self.step_until(lambda: "was killed" in self.live.message, "the kill")
        path = f"/dev/shm/nendo-{run.name}"
        self.addCleanup(os.unlink, path)
        with open(path, "rb") as file:
            content = bytearray(file.read())
        struct.pack_into("=H", content, 12, 2)
        os.unlink(path)
        with open(path, "wb") as file:
            file.write(content)
        self.step_until(lambda: "version 2" in self.live.message, "version 2")
        self.assertEqual(len(bpy.data.objects), 4)

    def test_a_model_that_is_edited_is_left_alone(self):
        self.connect(self.run_nendo("--mesh", os.path.join(MODELS, "moai.obj"), "--mode", "type2"))
        model = self.live.objects.find("model")
        bpy.context.view_layer.objects.active = model
        bpy.ops.object.mode_set(mode="EDIT")
        before = self.live.frame.number
        self.step_for(0.5)
        self.assertGreater(self.live.frame.number, before)
        bpy.ops.object.mode_set(mode="OBJECT")
        still = world_vertices(model)
        self.step_until(lambda: not np.array_equal(world_vertices(model), still), "the shape after editing")

    def test_objects_that_the_user_removes_or_renames(self):
        self.connect(self.run_nendo("--mesh", os.path.join(MODELS, "moai.obj")))
        self.live.objects.find("model").name = "my head"
        self.step_for(0.2)
        self.assertEqual(self.live.objects.find("model").name, "my head")
        bpy.data.objects.remove(self.rig(0))
        bpy.data.objects.remove(self.live.objects.find("model"))
        self.step_for(0.2)
        self.assertEqual((self.rig(0), self.live.objects.find("model")), (None, None))
        bpy.ops.nendo.make_objects()
        self.step_for(0.2)
        self.assert_hand(self.rig(0), joints_in_segment(self.live.link.name, self.live.frame.number)[0], 0, "made again")
        self.assertGreater(diagonal(world_vertices(self.live.objects.find("model"))), 0.5)

    def test_the_objects_are_found_after_an_undo(self):
        self.connect(self.run_nendo("--mesh", os.path.join(MODELS, "moai.obj")))
        bpy.ops.ed.undo_push(message="one")
        self.live.objects.find("stage").location.x = 3.0
        bpy.ops.ed.undo_push(message="two")
        self.step_for(0.2)
        bpy.ops.ed.undo()
        self.step_for(0.2)
        self.assertEqual(self.live.objects.find("stage").location.x, 0.0)
        self.assert_hand(self.rig(1), joints_in_segment(self.live.link.name, self.live.frame.number)[1], 1, "after an undo")

    def test_hands_without_a_model(self):
        name = f"judge-hands-{os.getpid()}"
        with open(os.path.join(WORK, "serve.log"), "wb") as log:
            server = subprocess.Popen([NENDO, "serve", "--name", name, "sim?hand=left", "sim:grasp", "--to", f"shm:{name}"],
                                      stdin=subprocess.DEVNULL, stdout=log, stderr=log, env={**os.environ, "XDG_RUNTIME_DIR": WORK})
        self.addCleanup(server.wait, 30)
        self.addCleanup(server.send_signal, signal.SIGINT)
        bpy.ops.nendo.connect(name=name)
        self.step_until(lambda: self.live.frame is not None and self.rig(1) is not None, "the hands")
        self.step_for(0.2)
        self.assert_hand(self.rig(1), joints_in_segment(name, self.live.frame.number)[1], 1, "served")
        self.assertIn(name, part("segment").names_of_runs())

    def test_a_step_with_32761_vertices(self):
        grid = np.stack(np.meshgrid(np.linspace(-1, 1, 181), np.linspace(-1, 1, 181), indexing="ij"), -1).reshape(-1, 2)
        points = np.concatenate([grid, 0.3 * np.cos(2 * grid[:, :1])], axis=1)
        at = np.arange(181 * 181).reshape(181, 181)
        quads = np.stack([at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]], -1).reshape(-1, 4)
        path = os.path.join(WORK, "grid.ply")
        part("ply").write(path, points, np.full(len(quads), 4), quads.ravel())
        self.connect(self.run_nendo("--mesh", path, "--no-injective"))
        self.assertEqual(self.live.link.content.vertices, 32761)
        self.step_for(1.0)
        figures = {"wall": [], "CPU": [], "CPU with the evaluated scene": []}
        end = time.monotonic() + 120.0
        while len(figures["wall"]) < 200:  # of steps that show a new shape
            self.assertLess(time.monotonic(), end)
            wall, cpu, before = time.perf_counter(), time.thread_time(), self.live._shown
            self.live.step()
            stepped_s, computed_s = time.perf_counter() - wall, time.thread_time() - cpu
            bpy.context.view_layer.update()
            if self.live._shown != before:
                figures["wall"].append(stepped_s)
                figures["CPU"].append(computed_s)
                figures["CPU with the evaluated scene"].append(time.thread_time() - cpu)
            time.sleep(0.01)
        for name, seconds in figures.items():
            seconds.sort()
            report(f"a step that shows 32,761 vertices, {name}: p50 {1e3 * statistics.median(seconds):.2f} ms, "
                   f"p99 {1e3 * seconds[int(0.99 * len(seconds))]:.2f} ms")
        self.assertLess(statistics.median(figures["CPU with the evaluated scene"]), 0.010)


class Recording(TestCase):
    def record(self, shape_as, seconds):
        run = self.run_nendo("--mesh", os.path.join(MODELS, "moai.obj"), "--mode", "type2")
        self.connect(run)
        scene = bpy.context.scene
        scene.render.fps, scene.nendo_live.shape_as = 24, shape_as
        scene.frame_set(11)
        self.assertEqual(bpy.ops.nendo.record(), {"FINISHED"})
        self.step_for(seconds)
        take = self.live.take
        bpy.ops.nendo.end_record()
        self.step_until(lambda: not self.live.is_building(), "the take")
        run.end()
        self.assertGreater(take.length, 24 * seconds / 2)
        return take

    def compare(self, take, shapes):
        """Plays the take without a connection."""
        self.live.disconnect()
        collection = bpy.data.collections["Nendo take 1"]
        rigs = [next(each for each in collection.objects if each.name.startswith(hand)) for hand in ("left hand", "right hand")]
        model = next((each for each in collection.objects if each.type == "MESH"), None)
        for at in range(0, take.length, 5):
            bpy.context.scene.frame_set(11 + at)
            for side, rig in enumerate(rigs):
                self.assert_hand(rig, dict(take.hands[side])[at], side, f"key {at}")
            if shapes:
                wanted = shapes[max(each for each in shapes if each <= at)]
                self.assertLess(np.abs(world_vertices(model) - wanted).max() / diagonal(wanted), NEAR, f"shape {at}")
        report(f"take of {take.length} frames: {[len(bpy.data.actions), model and len(model.data.vertices)]} actions, vertices")

    def test_a_take_with_shape_keys(self):
        take = self.record("KEYS", 1.5)
        self.assertGreater(len(take.shapes), 2)
        bpy.ops.ed.undo_push(message="what the user does later")
        bpy.ops.ed.undo()
        self.assertIn("Nendo take 1", bpy.data.collections)
        self.compare(take, dict(take.shapes))

    def test_a_take_with_a_cache(self):
        self.assertRaisesRegex(RuntimeError, "Save the .blend first", self.record, "CACHE", 0.5)
        self.clear()
        bpy.ops.wm.save_as_mainfile(filepath=os.path.join(WORK, "take.blend"))
        add = part("keys").PointCache.add
        added = []
        part("keys").PointCache.add = lambda cache, points: (added.append(points), add(cache, points))[1]
        try:
            take = self.record("CACHE", 1.5)
        finally:
            part("keys").PointCache.add = add
        self.assertEqual((len(added), take.cache.frames), (take.length, take.length))
        self.compare(take, dict(enumerate(added)))

    def test_a_take_ends_with_its_model(self):
        run = self.run_nendo("--mesh", os.path.join(MODELS, "moai.obj"), "--mode", "type2")
        self.connect(run)
        vertices = self.live.link.content.vertices
        bpy.context.scene.nendo_live.shape_as = "KEYS"
        bpy.ops.nendo.record()
        self.step_until(lambda: self.live.take.length > 5, "five frames")
        take = self.live.take
        run.end()
        self.run_nendo("--mesh", os.path.join(MODELS, "spot.obj"), name=run.name)
        self.step_until(lambda: self.live.link.content.vertices != vertices and self.live.take is None, "the next run")
        model = next(each for each in bpy.data.collections["Nendo take 1"].objects if each.type == "MESH")
        self.assertEqual(len(model.data.vertices), vertices)
        self.assertEqual(len(model.data.shape_keys.key_blocks), len(take.shapes))
        self.assertEqual(len(self.live.objects.find("model").data.vertices), self.live.link.content.vertices)

    def test_ticks_while_the_interface_is_busy_are_recorded(self):
        self.connect(self.run_nendo("--mesh", os.path.join(MODELS, "moai.obj")))
        bpy.context.scene.nendo_live.shape_as = "NONE"
        bpy.ops.nendo.record()
        self.step_until(lambda: self.live.take.last_number > 0, "the first tick")
        take, segment = self.live.take, self.live.link._segment
        add, numbers, end = take.add_frame, [], time.monotonic() + 60
        take.add_frame = lambda frame: (numbers.append(frame.number), add(frame))
        while time.monotonic() < end:
            numbers.clear()
            before = take.last_number
            while segment.newest() < before + 8:
                time.sleep(0.005)
            self.live.step()
            if segment.oldest(segment.newest()) <= before + 1:
                break  # otherwise the busy machine was slower than the ring of records
        self.assertGreaterEqual(len(numbers), 8)
        self.assertEqual(numbers, list(range(before + 1, before + 1 + len(numbers))))
        self.assertEqual([at for at, _ in take.hands[0]], list(range(take.length)))


class Shaping(TestCase):
    def setUp(self):
        super().setUp()
        preferences = bpy.context.preferences.addons[INSTALLED].preferences
        preferences.program, preferences.left, preferences.right = NENDO, "sim:sculpt?seed=7", "sim:sculpt?seed=8"
        preferences.more, preferences.web = "", False
        self.preferences = preferences

    def add(self, name, vertices, faces, matrix=Matrix()):
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata([tuple(each) for each in vertices], [], faces)
        mesh.materials.append(bpy.data.materials.new("red"))
        thing = bpy.data.objects.new(name, mesh)
        bpy.context.scene.collection.objects.link(thing)
        thing.matrix_world = matrix
        bpy.context.view_layer.objects.active = thing
        bpy.context.view_layer.update()
        return thing

    def ball(self, scale=(1.0, 1.0, 1.0)):
        matrix = Matrix.LocRotScale(Vector((4.0, -3.0, 2.0)), Euler((0.4, -0.7, 1.1)), Vector(scale) * 2.5)
        return self.add("ball", *ball(24, 32), matrix)

    def shape(self):
        self.assertEqual(bpy.ops.nendo.shape(), {"FINISHED"})
        self.step_until(lambda: self.live.frame is not None and self.live.objects.find("model") is not None, "the run")

    def end_run(self):
        """Ends the process alone; the add-on still has the last shape. Returns it in the world's axes, from nendo's own file."""
        shaped = self.live.shaping
        shaped.run.stop()
        self.step_until(lambda: shaped.run.exit_code() is not None, "the end")
        self.assertEqual(shaped.run.exit_code(), 0, shaped.run.last_line())
        self.step_until(lambda: "has ended" in self.live.message, "the end")
        points = read_ply(os.path.join(shaped.run.folder, "shaped.ply"))
        return np.stack([points[:, 0], -points[:, 2], points[:, 1]], axis=1) + (4.0, -3.0, 2.0)

    def compare(self, found, wanted):
        self.assertEqual(found.shape, wanted.shape)
        self.assertLess(np.linalg.norm(found - wanted, axis=1).max() / diagonal(wanted), 2 * NEAR)

    def test_a_model_goes_out_and_comes_back_as_shape_key(self):
        thing = self.ball()
        before = world_vertices(thing)
        self.shape()
        self.assertTrue(thing.hide_get())
        live = self.live.objects.find("model")
        self.assertEqual((len(live.data.polygons), live.data.materials[0].name), (len(thing.data.polygons), "red"))
        self.assertLess(np.median(np.linalg.norm(world_vertices(live) - before, axis=1)), 0.1 * diagonal(before))
        self.step_for(SECOND)
        wanted = self.end_run()
        self.assertEqual(bpy.ops.nendo.bring_key(), {"FINISHED"})
        self.live.step()
        self.compare(world_vertices(live), wanted)
        bpy.ops.nendo.end_shaping()
        self.assertFalse(thing.hide_get())
        self.assertEqual([key.name for key in thing.data.shape_keys.key_blocks], ["Basis", "Nendo"])
        self.compare(world_vertices(thing), wanted)
        self.assertGreater(np.abs(wanted - before).max(), 0.02 * diagonal(before))
        thing.data.shape_keys.key_blocks["Nendo"].value = 0.0
        self.compare(world_vertices(thing), before)
        self.assertEqual([each.name for each in bpy.data.objects], ["ball"])

    def test_a_mirrored_model_comes_back_as_mesh(self):
        thing = self.ball((-1.0, 1.0, 0.5))
        before = world_vertices(thing)
        self.shape()
        self.step_for(SECOND)
        wanted = self.end_run()
        self.assertEqual(bpy.ops.nendo.bring_mesh(), {"FINISHED"})
        bpy.ops.nendo.end_shaping()
        shaped = bpy.data.objects["ball shaped"]
        self.compare(world_vertices(shaped), wanted)
        self.compare(world_vertices(thing), before)
        self.assertEqual((len(shaped.data.polygons), shaped.data.materials[0].name), (len(thing.data.polygons), "red"))
        self.assertEqual((thing.hide_get(), shaped.hide_get()), (True, False))

    def test_a_model_with_other_vertices_comes_back_as_mesh_alone(self):
        self.preferences.more = "--refine 4000"
        thing = self.ball()
        self.shape()
        vertices = len(thing.data.vertices)
        self.step_until(lambda: self.live.link.content.vertices != vertices, "another number of vertices")
        self.assertRaisesRegex(RuntimeError, "bring it back as a mesh", bpy.ops.nendo.bring_key)
        self.end_run()
        self.assertEqual(bpy.ops.nendo.bring_mesh(), {"FINISHED"})
        self.live.objects.show_shape(self.live.link.current()[1], self.live.link.content, self.live.frame)
        self.compare(world_vertices(bpy.data.objects["ball shaped"]), world_vertices(self.live.objects.find("model")))

    def test_what_goes_wrong_is_one_line(self):
        thing = self.ball()
        self.preferences.program = "no-such-nendo"
        self.assertRaisesRegex(RuntimeError, "no-such-nendo: there is no such program", bpy.ops.nendo.shape)
        self.preferences.program, self.preferences.more = NENDO, "--mode 'type2"
        self.assertRaisesRegex(RuntimeError, "No closing quotation", bpy.ops.nendo.shape)
        self.preferences.more = "--mode type9"
        bpy.ops.nendo.shape()
        self.step_until(lambda: self.live.shaping is None, "the refusal")
        self.assertRegex(self.live.message, "nendo ended with 2: .*type9")
        self.assertFalse(thing.hide_get())
        self.preferences.more = ""
        self.shape()
        thing.name = "renamed"
        self.assertRaisesRegex(RuntimeError, "ball is gone, or has another name", bpy.ops.nendo.bring_key)
        bpy.ops.nendo.end_shaping()
        empty = self.add("empty", [(0, 0, 0)], [])
        self.assertRaisesRegex(RuntimeError, "empty has no faces", bpy.ops.nendo.shape)
        self.assertIsNotNone(empty)


class ZDisabling(TestCase):  # the last one
    def test_nothing_is_left_of_it(self):
        self.connect(self.run_nendo("--mesh", os.path.join(MODELS, "moai.obj")))
        follow = part("live")
        opened = [each for each in os.listdir("/proc/self/fd") if self.live.link.name in os.path.realpath(f"/proc/self/fd/{each}")]
        self.assertEqual(len(opened), 1)
        name = self.live.link.name
        bpy.ops.preferences.addon_disable(module=INSTALLED)
        self.assertFalse(bpy.app.timers.is_registered(follow.tick))
        self.assertFalse(any("nendo" in getattr(each, "__module__", "") for each in bpy.app.handlers.load_pre))
        self.assertFalse(any(name in os.path.realpath(f"/proc/self/fd/{each}") for each in os.listdir("/proc/self/fd")))
        with open("/proc/self/maps") as maps:
            self.assertNotIn(name, maps.read())
        self.assertFalse(hasattr(bpy.types.Scene, "nendo_live"))
        bpy.ops.preferences.addon_enable(module=INSTALLED)
        self.assertTrue(hasattr(bpy.types.Scene, "nendo_live"))


INSTALLED = install()
bpy.context.preferences.view.show_developer_ui = False
report(f"Blender {bpy.app.version_string}, Python {sys.version.split()[0]}, NumPy {np.__version__}, {INSTALLED}")
suite = unittest.defaultTestLoader.loadTestsFromNames(os.environ.get("NENDO_TESTS", "").split() or
                                                      ["Following", "Recording", "Shaping", "ZDisabling"], sys.modules[__name__])
for each in list(bpy.data.objects):
    bpy.data.objects.remove(each)
done = unittest.TextTestRunner(verbosity=2).run(suite)
sys.exit(0 if done.wasSuccessful() and done.testsRun else 1)
