import os
import pathlib
import struct
import subprocess
import time
import unittest

import numpy as np

import nendo
from fixtures import MOAI, PROGRAM, TestCase, seconds_after_interrupt

LIVE, ENDED = 1, 2


def segment(minor=2, state=ENDED, **changes):
    """A segment with one record of a tetrahedron, byte for byte by apps/publish/FORMAT.md."""
    vertices, triangles, number = 4, [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3], 1
    setup, faces, rest, record, shape, states = 192, 320, 368, 416, 2032, 2160
    bytes_ = bytearray(2720 + 208)
    fields = {"magic": (0, "8s", b"NENDOPUB"), "order": (8, "I", 0x01020304), "major": (12, "H", 1), "minor": (14, "H", minor),
              "length": (16, "Q", len(bytes_)), "vertices": (28, "I", vertices), "triangles": (32, "I", len(triangles) // 3),
              "record_slots": (36, "I", 1), "shape_slots": (40, "I", 1), "setup": (48, "Q", setup), "faces": (56, "Q", faces),
              "rest": (64, "Q", rest), "record": (72, "Q", record), "record_stride": (80, "Q", 1616), "shape": (88, "Q", shape),
              "shape_stride": (96, "Q", 112), "state": (128, "I", state), "newest": (136, "Q", number)}
    if minor >= 2:
        fields |= {"states_stride": (44, "I", 560), "states": (120, "Q", states)}
    for name, (at, form, value) in fields.items():
        struct.pack_into("=" + form, bytes_, at, changes.pop(name, value))
    struct.pack_into("=2Q6dI", bytes_, setup, 4, 1, 1.0, 2.0, 3.0, 0.5, 90.0, 2.0, 1)
    struct.pack_into("=3d", bytes_, setup + 72, 10.0, 0.0, 0.0)
    struct.pack_into("=12I", bytes_, faces, *changes.pop("corners", triangles))
    struct.pack_into("=8Q3qQd4IQ", bytes_, record, 4, number, 1, 7, 8, 0, 0, 0, 0, 2_500_000_000, 0, 1, 2.0, 1, 0, 1, 0, 0)
    joints = np.arange(26 * 7, dtype=np.float32) / 64
    struct.pack_into("=2IQ182f", bytes_, record + 128 + 744, 3, 0, 5, *joints)
    coordinates = np.arange(12, dtype=np.float32)
    struct.pack_into("=3Q", bytes_, shape, 4, number, 1)
    struct.pack_into("=12f", bytes_, shape + 64, *coordinates)
    angles = np.linspace(-1, 1, 23)
    struct.pack_into("=2Q", bytes_, states, 4, number)
    struct.pack_into("=2I2q23d", bytes_, states + 32 + 264, 0, 0, 0, 0, *angles)
    assert not changes
    return bytes_, {"hand": joints.reshape(26, 7), "angles": angles, "faces": np.array(triangles, np.uint32).reshape(-1, 3),
                    "vertices": [11.0, 2, 3] + 0.5 * coordinates.reshape(4, 3).astype(float)}


class Segments(TestCase):
    def setUp(self):
        super().setUp()
        self.name = f"test-{os.getpid()}"
        self.path = pathlib.Path(f"/dev/shm/nendo-{self.name}")
        self.addCleanup(self.path.unlink, missing_ok=True)

    def attach(self, content):
        self.path.write_bytes(content)
        return nendo.attach(self.name)

    def test_every_number_is_that_of_the_format(self):
        for minor in (0, 1, 2, 9):
            content, expected = segment(minor)
            run = self.attach(content)
            self.assertEqual(run.version, (1, minor))
            hands = run.hands()
            self.assertTrue(np.isnan(hands[0]).all())
            self.assert_same(hands[1], expected["hand"].astype(float))
            self.assert_same(run.vertices(), expected["vertices"])
            self.assert_same(run.faces, expected["faces"])
            frame = run.frame()
            self.assertEqual((frame.number, frame.time_s, frame.held, frame.units_per_metre), (1, 2.5, True, 2.0))
            self.assertEqual((frame.present.tolist(), frame.silent.tolist()), ([False, True], [False, True]))
            if minor < 2:
                self.assertTrue(np.isnan(frame.angles).all())
                with self.assertRaisesRegex(nendo.Error, "1.2"):
                    run.angles()
            else:
                self.assert_same(run.angles()[1], expected["angles"])
            self.assertEqual(([frame.number for frame in run], run.has_ended), ([1], True))

    def test_wrong_segments_are_errors(self):
        big = 1 << 62
        for wrong in ({"magic": b"NENDOPUX"}, {"order": 0x04030201}, {"major": 2}, {"state": 0}, {"record_slots": 0},
                      {"shape_slots": 1 << 30}, {"setup": big}, {"faces": 1 << 20}, {"record": 8 * 400}, {"record_stride": 8},
                      {"shape_stride": 64}, {"vertices": 1 << 31}, {"triangles": 1 << 31}, {"states": big}, {"length": 1 << 20},
                      {"rest": 3}):
            with self.assertRaises(nendo.Error, msg=wrong) as caught:
                self.attach(segment(**wrong)[0])
            self.assertEqual(caught.exception.code, "bad_input")
        for content in (b"", b"NENDOPUB", bytes(4096)):
            with self.assertRaises(nendo.Error):
                self.attach(content)
        with self.assertRaises(nendo.Error):
            self.attach(segment(corners=[9] * 12)[0]).faces
        random, whole = np.random.default_rng(4), segment()[0]
        for _ in range(300):
            content = bytearray(whole)
            for at in random.integers(0, 416, 3):
                content[at] = random.integers(256)
            try:
                run = self.attach(content)
                run.hands(), run.angles(), run.vertices(), run.faces
            except nendo.Error:
                pass
        self.path.unlink()
        with self.assertRaises(FileNotFoundError):
            nendo.attach(self.name)
        for name in ("", "../passwd"):
            with self.assertRaises(ValueError):
                nendo.attach(name)

    def test_a_writer_that_changes_the_header_later_is_harmless(self):
        content, expected = segment()
        run = self.attach(content)
        with open(self.path, "r+b") as file:
            for at in (28, 36, 48, 72, 88, 120):
                file.seek(at)
                file.write(b"\xff" * 4)
            file.flush()
            self.assert_same(run.vertices(), expected["vertices"])
            self.assert_same(run.faces, expected["faces"])

    def test_a_run_is_followed_to_its_end(self):
        arguments = ["run", MOAI, "--left", "sim:sculpt", "--right", "sim:sculpt", "--duration", "3", "--out", "out.ply", "--to",
                     f"shm:{self.name}"]
        with subprocess.Popen([PROGRAM, *map(str, arguments)], cwd=self.folder, stdout=subprocess.DEVNULL) as program:
            run = self.eventually_attached()
            frames = list(run)
            shape, faces = run.vertices(), run.faces
            self.assertEqual(program.wait(timeout=30), 0)
        numbers = [frame.number for frame in frames]
        self.assertEqual(numbers, sorted(set(numbers)))
        self.assertGreater(len(numbers), 50)
        self.assertTrue(all(frame.present.all() for frame in frames))
        out = nendo.Mesh.read(self.folder / "out.ply")
        self.assert_near(shape, out.vertices, 1e-6)
        self.assert_same(faces, out.faces)

    def test_a_killed_run_ends_the_iteration(self):
        arguments = ["run", MOAI, "--right", "sim", "--out", "out.ply", "--to", f"shm:{self.name}"]
        program = subprocess.Popen([PROGRAM, *map(str, arguments)], cwd=self.folder, stdout=subprocess.DEVNULL)
        run = self.eventually_attached()
        next(run)
        self.assertFalse(run.has_ended)
        program.kill()
        program.wait()
        list(run)
        self.assertTrue(run.has_ended)

    def eventually_attached(self):
        end = time.monotonic() + 10
        while True:
            try:
                run = nendo.attach(self.name)
                run.frame()
                return run
            except nendo.Error:
                if time.monotonic() > end:
                    raise
                time.sleep(0.01)

    def test_ctrl_c_ends_the_wait_for_a_record(self):
        self.path.write_bytes(segment(state=LIVE)[0])
        code = """
            import fcntl, struct
            run = nendo.attach(sys.argv[1])
            next(run)
            print('waits')
            next(run)
        """
        with open(self.path, "r+b") as file:  # the writer's lock
            import fcntl
            fcntl.fcntl(file, 37, struct.pack("hhqqi4x", fcntl.F_WRLCK, os.SEEK_SET, 0, 0, 0))  # F_OFD_SETLK
            self.assertLess(seconds_after_interrupt(code, self.name), 0.2)


if __name__ == "__main__":
    unittest.main()
