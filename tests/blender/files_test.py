import ast
import os
import pathlib
import re
import signal
import struct
import subprocess
import sys
import tempfile
import time
import tomllib
import unittest
import zipfile

import numpy as np

import nendo_live
from nendo_live import keys, ply, process

ADD_ON = pathlib.Path(nendo_live.__file__).parent


class TestCase(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name


class Sampling(unittest.TestCase):
    def test_each_frame_gets_the_nearest_tick(self):
        random = np.random.default_rng(1)
        for rate_hz in (24.0, 29.97, 60.0):
            times_ns = np.cumsum(random.integers(1_000_000, 80_000_000, 200))
            sampler = keys.Sampler(rate_hz)
            chosen = [each for at, ns in enumerate(times_ns) for each in sampler.feed(int(ns), at)]
            self.assertEqual([frame for frame, _ in chosen], list(range(len(chosen))))
            self.assertGreater(len(chosen), 50)
            positions = (times_ns - times_ns[0]) / 1e9 * rate_hz
            for frame, at in chosen:
                self.assertAlmostEqual(abs(positions[at] - frame), np.abs(positions - frame).min(), places=9)


class PointCaches(TestCase):
    def test_the_file_is_a_pc2(self):
        path = os.path.join(self.folder, "take.pc2")
        cache = keys.PointCache(path, 5)
        frames = np.random.default_rng(2).normal(size=(7, 5, 3)).astype(np.float32)
        for each in frames:
            cache.add(each)
        cache.finish()
        data = pathlib.Path(path).read_bytes()
        self.assertEqual(struct.unpack_from("<12siiffi", data), (b"POINTCACHE2\0", 1, 5, 0.0, 1.0, 7))
        np.testing.assert_array_equal(np.frombuffer(data, "<f4", offset=32).reshape(7, 5, 3), frames)

    def test_nothing_is_left_of_one_that_is_discarded(self):
        cache = keys.PointCache(os.path.join(self.folder, "take.pc2"), 5)
        cache.discard()
        self.assertEqual(os.listdir(self.folder), [])


class Meshes(TestCase):
    def test_vertices_and_polygons_keep_their_order(self):
        vertices = np.random.default_rng(3).normal(size=(7, 3))
        faces = [[0, 1, 2], [2, 3, 4, 5], [6, 5, 4, 3, 2], [0, 2, 6]]
        path = os.path.join(self.folder, "model.ply")
        ply.write(path, vertices, [len(face) for face in faces], [corner for face in faces for corner in face])
        head, _, body = pathlib.Path(path).read_bytes().partition(b"end_header\n")
        self.assertTrue(head.startswith(b"ply\nformat binary_little_endian 1.0\nelement vertex 7\n"))
        self.assertIn(b"element face 4\n", head)
        self.assertEqual([list(each) for each in struct.iter_unpack("<3d", body[:168])], vertices.tolist())
        at, found = 168, []
        while at < len(body):
            found.append(list(struct.unpack_from(f"<{body[at]}i", body, at + 1)))
            at += 1 + 4 * body[at]
        self.assertEqual(found, faces)
        self.assertEqual(os.listdir(self.folder), ["model.ply"])

    def test_a_polygon_that_the_file_cannot_hold_is_refused(self):
        with self.assertRaises(ValueError):
            ply.write(os.path.join(self.folder, "model.ply"), np.zeros((300, 3)), [300], range(300))
        self.assertEqual(os.listdir(self.folder), [])


class Runs(TestCase):
    def finished(self, run):
        end = time.monotonic() + 30
        while run.exit_code() is None:
            self.assertLess(time.monotonic(), end)
            time.sleep(0.01)
        return run.exit_code()

    def test_the_command_has_the_users_options(self):
        words = process.command("nendo", "m.ply", "clay", "out.ply", {
            "left": "sim:sculpt", "right_wrist": "vrpn:a b@host", "right": "", "web": True,
            "more": "--mode type2 --mask 'my masks.toml'"})
        self.assertEqual(words, ["nendo", "run", "--mesh", "m.ply", "--to", "shm:clay", "--out", "out.ply", "--force", "--left",
                                 "sim:sculpt", "--right-wrist", "vrpn:a b@host", "--web", "0", "--mode", "type2", "--mask",
                                 "my masks.toml"])
        with self.assertRaises(ValueError):
            process.command("nendo", "m.ply", "clay", "out.ply", {"more": "--mask 'my"})

    def test_what_a_run_writes_is_read(self):
        script = "echo beginning; echo 'see http://127.0.0.1:4000/#abc now'; echo 'model: no such\x07 file' >&2; exit 3"
        run = process.Run(lambda folder: ["/bin/sh", "-c", script])
        self.assertEqual(self.finished(run), 3)
        self.assertEqual((run.address(), run.last_line()), ("http://127.0.0.1:4000/#abc", "model: no such file"))
        folder = run.folder
        run.end()
        self.assertFalse(os.path.exists(folder))
        self.assertEqual((run.address(), run.exit_code()), ("", 3))

    def test_a_program_that_does_not_exist_is_named(self):
        with self.assertRaisesRegex(FileNotFoundError, "no-such-nendo"):
            process.Run(lambda folder: [os.path.join(folder, "no-such-nendo"), "run"])

    def test_stop_is_a_ctrl_c(self):
        run = process.Run(lambda folder: [sys.executable, "-c", "import time; time.sleep(60)"])
        time.sleep(0.5)
        run.stop()
        self.assertIn(self.finished(run), (1, 130, -signal.SIGINT))
        run.end()

    def test_a_run_ends_when_blender_is_killed(self):
        code = ("import os, signal\nfrom nendo_live import process\n"
                "run = process.Run(lambda folder: ['/bin/sh', '-c', 'echo $$ >pid; exec sleep 60'])\n"
                "path = os.path.join(run.folder, 'pid')\n"
                "while not (os.path.exists(path) and os.path.getsize(path)): pass\n"
                "print(open(path).read(), run.folder, flush=True)\nos.kill(os.getpid(), signal.SIGKILL)\n")
        killed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
        pid, folder = killed.stdout.split()
        self.addCleanup(lambda: [os.unlink(each) for each in pathlib.Path(folder).iterdir()] and os.rmdir(folder))
        end = time.monotonic() + 30
        while os.path.exists(f"/proc/{pid}") and " Z " not in pathlib.Path(f"/proc/{pid}/stat").read_text():
            self.assertLess(time.monotonic(), end)
            time.sleep(0.01)


class Package(unittest.TestCase):
    def test_both_descriptions_have_the_version_of_nendo(self):
        manifest = tomllib.loads((ADD_ON / "blender_manifest.toml").read_text())
        self.assertEqual(manifest["version"], os.environ["NENDO_VERSION"])
        self.assertEqual(".".join(map(str, nendo_live.bl_info["version"])), os.environ["NENDO_VERSION"])
        self.assertEqual((manifest["id"], manifest["name"]), (ADD_ON.name, nendo_live.bl_info["name"]))

    def test_the_zip_has_the_add_on_and_nothing_else(self):
        with zipfile.ZipFile(os.environ["NENDO_ADD_ON_ZIP"]) as file:
            self.assertIsNone(file.testzip())
            contents = {name: file.read(name) for name in file.namelist() if not name.endswith("/")}
        wanted = {f"nendo_live/{each.name}": each.read_bytes() for each in ADD_ON.iterdir() if each.suffix in (".py", ".toml")}
        self.assertEqual(contents, wanted)

    def test_each_file_is_python_3_10(self):
        for each in ADD_ON.glob("*.py"):
            ast.parse(each.read_text(), feature_version=(3, 10))

    def test_only_these_files_need_blender(self):
        imports = re.compile(r"^import bpy|^from bpy|^from mathutils", re.M)
        needing = {each.stem for each in ADD_ON.glob("*.py") if imports.search(each.read_text())}
        self.assertEqual(needing, {"compat", "live", "panel", "scene", "shaping", "takes"})


if __name__ == "__main__":
    unittest.main()
