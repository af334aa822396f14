import importlib.util
import os
import struct
import tempfile
import time
import unittest

import numpy as np

from nendo_live import link, segment
from segments import ENDED, SETUP, Writer, floats_of, joints_of


class TestCase(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def writer(self, name="clay", **options):
        made = Writer(self.folder, name, **options)
        self.addCleanup(made.close)
        return made

    def open(self, name="clay"):
        opened = segment.open_segment(name, self.folder)
        self.addCleanup(opened.close)
        return opened


class Reading(TestCase):
    def test_every_number_is_that_of_the_format(self):
        for minor in (0, 1, 2, 9):
            writer = self.writer(minor=minor).create()
            number = writer.publish(present=2)
            run = self.open()
            self.assertEqual((run.version, run.newest(), run.life()), ((1, minor), number, segment.RUNS))
            setup = run.setup()
            self.assertEqual((setup.generation, setup.unit, setup.rate_hz), (1, 0.5, 90.0))
            self.assertEqual((setup.origin.tolist(), setup.offset.tolist()), ([1, 2, 3], [10, 0, 0]))
            np.testing.assert_array_equal(run.triangles(setup), writer.triangles)
            self.assertEqual(run.radii_m(setup).max(), np.float32(0.008) if minor >= 2 else 0)
            frame = run.frame(number)
            self.assertEqual((frame.number, frame.tick, frame.units_per_metre), (number, number + 6, 2.0))
            self.assertEqual((frame.present, frame.silent), ((False, True), (False, False)))
            np.testing.assert_array_equal(frame.joints, joints_of(number))
            np.testing.assert_array_equal(run.shape(number, setup), floats_of(number, 4))

    def test_wrong_headers_are_refused_with_a_reason(self):
        big = 1 << 62
        for wrong, reason in (
                ({"magic": b"NENDOPUX"}, "not a segment"), ({"order": 0x04030201}, "byte order"), ({"major": 2}, "version 2"),
                ({"state": 0}, "damaged"), ({"record_slots": 0}, "damaged"), ({"record_slots": 1 << 31}, "damaged"),
                ({"shape_slots": 1 << 30}, "damaged"), ({"setup": big}, "damaged"), ({"setup": 193}, "damaged"),
                ({"faces": 1 << 20}, "damaged"), ({"faces": (1 << 64) - 8}, "damaged"), ({"records": 8 * 4000}, "damaged"),
                ({"record_stride": 8}, "damaged"), ({"record_stride": big}, "damaged"), ({"shape_stride": 64}, "damaged"),
                ({"vertices": 1 << 31}, "vertices"), ({"triangles": 1 << 31}, "vertices"), ({"vertices": 1 << 20}, "damaged"),
                ({"length": 1 << 40}, "damaged"), ({"rest": 3}, "damaged")):
            self.writer(header=wrong).create()
            with self.assertRaisesRegex(segment.SegmentError, reason, msg=wrong):
                self.open()
        for content in (b"", b"NENDOPUB", bytes(4096)):
            with open(os.path.join(self.folder, "nendo-clay"), "wb") as file:
                file.write(content)
            with self.assertRaisesRegex(segment.SegmentError, "not a segment"):
                self.open()

    def test_a_file_cut_anywhere_is_refused(self):
        writer = self.writer()
        path = os.path.join(self.folder, "nendo-cut")
        for length in [*range(0, 600, 7), *range(600, len(writer.bytes), 997)]:
            with open(path, "wb") as file:
                file.write(writer.bytes[:length])
            with self.assertRaises(segment.SegmentError):
                self.open("cut")

    def test_a_file_cut_while_it_is_read_ends_nothing(self):
        writer = self.writer().create()
        number = writer.publish()
        run = self.open()
        setup = run.setup()
        os.truncate(writer.path, 100)
        self.assertEqual((run.frame(number), run.shape(number, setup), run.setup(), run.newest()), (None, None, None, 0))
        self.assertIsNone(run.triangles(setup))

    def test_a_header_that_changes_later_is_not_read_again(self):
        writer = self.writer().create()
        number = writer.publish()
        run = self.open()
        setup = run.setup()
        for at in (28, 32, 36, 40, 48, 56, 72, 80, 88, 96):
            writer.put(at, "I", 0xFFFFFFFF)
        np.testing.assert_array_equal(run.shape(number, setup), floats_of(number, 4))
        np.testing.assert_array_equal(run.frame(number).joints, joints_of(number))

    def test_damaged_bytes_raise_nothing_else(self):
        random = np.random.default_rng(5)
        path = os.path.join(self.folder, "nendo-random")
        whole = self.writer("whole").create()
        whole.publish()
        with open(whole.path, "rb") as file:
            content = file.read()
        opened = 0
        for _ in range(400):
            damaged = bytearray(content)
            for at in random.integers(0, 700, 3):
                damaged[at] = random.integers(256)
            with open(path, "wb") as file:
                file.write(damaged)
            try:
                run = segment.open_segment("random", self.folder)
            except segment.SegmentError:
                continue
            opened += 1
            try:
                run.life()
                setup = run.setup()
                if setup:
                    run.triangles(setup)
                    run.radii_m(setup)
                    run.shape(run.newest(), setup)
                run.frame(run.newest())
            except segment.SegmentError:
                pass
            run.close()
        self.assertGreater(opened, 30)

    def test_content_that_is_being_written_is_not_used(self):
        writer = self.writer().create()
        number = writer.publish()
        run = self.open()
        setup = run.setup()
        record, shape = writer.records + number * writer.stride, writer.shapes + number * writer.shape_stride
        for stage in (2 * number + 1, 2 * (number + writer.slots) + 2, 0):
            writer.put(record, "Q", stage)
            writer.put(shape, "Q", stage)
            self.assertEqual((run.frame(number), run.shape(number, setup)), (None, None))
        writer.put(record, "Q", 2 * number + 2)
        writer.put(shape, "2Q", 2 * number + 2, number + 4)
        self.assertIsNotNone(run.frame(number))
        self.assertIsNone(run.shape(number, setup))
        writer.put(shape, "2Q", 2 * number + 2, number)
        self.assertIsNotNone(run.shape(number, setup))
        writer.put(SETUP, "Q", 2 * setup.generation + 3)
        self.assertEqual((run.shape(number, setup), run.setup(), run.triangles(setup)), (None, None, None))

    def test_numbers_that_are_not_finite_are_not_used(self):
        writer = self.writer().create()
        run = self.open()
        setup = run.setup()
        floats = floats_of(1, 4)
        floats[2, 1] = np.nan
        number = writer.publish(floats=floats)
        self.assertIsNone(run.shape(number, setup))
        joints = joints_of(1)
        joints[1, 3, 5] = np.inf
        self.assertIsNone(run.frame(writer.publish(joints=joints)))
        writer.put(SETUP + 40, "d", float("nan"))
        with self.assertRaisesRegex(segment.SegmentError, "impossible"):
            run.setup()

    def test_triangles_without_vertices_are_refused(self):
        self.writer(triangles=[[0, 1, 4]]).create()
        run = self.open()
        with self.assertRaisesRegex(segment.SegmentError, "vertex that does not exist"):
            run.triangles(run.setup())

    def test_links_and_other_files_are_refused(self):
        writer = self.writer("real").create()
        os.symlink(writer.path, os.path.join(self.folder, "nendo-linked"))
        os.mkfifo(os.path.join(self.folder, "nendo-pipe"))
        for name in ("linked", "pipe", "", "../passwd", "a\0b"):
            with self.assertRaises(segment.SegmentError):
                self.open(name)
        with self.assertRaises(FileNotFoundError):
            self.open("absent")

    def test_life(self):
        writer = self.writer().create()
        run = self.open()
        self.assertEqual(run.life(), segment.RUNS)
        writer.close()
        self.assertEqual(run.life(), segment.KILLED)
        self.writer("other", header={"state": ENDED}).create()
        self.assertEqual(self.open("other").life(), segment.ENDED)

    def test_runs_are_listed_while_they_live(self):
        for name in ("b", "a"):
            self.writer(name).create()
        self.writer("dead").create(locked=False)
        self.writer("newer", header={"major": 2}).create()
        self.assertEqual(segment.names_of_runs(self.folder), ["a", "b"])
        self.assertEqual(segment.names_of_runs(os.path.join(self.folder, "absent")), [])


class OtherProcessors(TestCase):
    def test_without_the_module_there_is_one_line(self):
        if importlib.util.find_spec("nendo"):
            self.skipTest("the module nendo is here")
        self.writer().create()
        with self.assertRaisesRegex(segment.SegmentError, "python3-nendo"):
            segment.open_segment("clay", self.folder, "aarch64")

    def test_the_module_reads_the_same(self):
        if not importlib.util.find_spec("nendo"):
            self.skipTest("the module nendo is not here")
        name = f"test-blender-{os.getpid()}"
        writer = Writer("/dev/shm", name).create()
        self.addCleanup(os.unlink, writer.path)
        self.addCleanup(writer.close)
        number = writer.publish()
        runs = [segment.open_segment(name, machine=machine) for machine in ("x86_64", "aarch64")]
        self.assertIsInstance(runs[1], segment.ModuleSegment)
        frames = [run.frame(number) for run in runs]
        np.testing.assert_array_equal(frames[0].joints, frames[1].joints)
        self.assertEqual((frames[0].present, frames[0].units_per_metre), (frames[1].present, frames[1].units_per_metre))
        shapes = [run.shape(number, run.setup()) for run in runs]
        np.testing.assert_allclose(shapes[0], shapes[1], atol=1e-6)
        self.assertEqual(runs[1].oldest(number), number)
        writer.put(writer.records + number * writer.stride, "Q", 2 * number + 1)
        self.assertIsNone(runs[1].frame(number))
        for run in runs:
            run.close()


class Following(TestCase):
    def setUp(self):
        super().setUp()
        self.now = 0.0
        self.link = link.Link("clay", self.folder, lambda: self.now)
        self.addCleanup(self.link.close)

    def poll(self):
        self.now += 1.0
        return self.link.poll()

    def test_a_run_is_awaited_and_followed(self):
        self.assertIsNone(self.poll())
        self.assertIn("nendo run --to shm:clay", self.link.state)
        writer = self.writer().create()
        self.assertIsNone(self.poll())
        self.assertEqual(self.link.state, "The run clay begins")
        number = writer.publish()
        frame = self.poll()
        self.assertEqual((frame.number, self.link.epoch, self.link.state), (number, 1, "Connected to the run clay"))
        np.testing.assert_array_equal(self.link.shape(frame), floats_of(number, 4))
        self.assertIsNone(self.poll())
        for _ in range(3):
            writer.publish()
        self.assertEqual([each.number for each in self.link.frames(number)], [2, 3, 4])
        self.assertEqual(self.poll().number, 4)

    def test_frames_that_were_overwritten_are_left_out(self):
        writer = self.writer(slots=8).create()
        for _ in range(30):
            writer.publish()
        self.poll()
        numbers = [each.number for each in self.link.frames(0)]
        self.assertEqual(numbers, list(range(24, 31)))

    def test_a_run_that_ends_and_starts_again_with_another_model(self):
        first = self.writer().create()
        first.publish()
        self.poll()
        first.end()
        self.assertIsNone(self.poll())
        self.assertIn("has ended", self.link.state)
        self.assertEqual(self.link.current()[0].number, 1)  # memory of an ended run stays readable
        second = self.writer(triangles=[[0, 1, 2], [2, 3, 4]], vertices=5).create()
        second.publish()
        second.publish()
        frame = self.poll()
        self.assertEqual((frame.number, self.link.epoch, self.link.content.vertices), (2, 2, 5))
        self.assertEqual(self.link.state, "Connected to the run clay")

    def test_a_killed_run(self):
        writer = self.writer().create()
        writer.publish()
        self.poll()
        writer.close()
        self.assertIsNone(self.poll())
        self.assertIn("was killed", self.link.state)
        self.writer().create().publish()
        self.assertEqual((self.poll().number, self.link.epoch), (1, 2))

    def test_a_newer_version_is_named_and_then_awaited(self):
        writer = self.writer().create()
        writer.publish()
        self.poll()
        writer.end()
        self.writer(header={"major": 2}).create()
        for _ in range(3):
            self.assertIsNone(self.poll())
        self.assertIn("version 2", self.link.state)
        self.writer().create().publish()
        self.assertIsNotNone(self.poll())

    def test_a_suspended_run(self):
        writer = self.writer().create()
        writer.publish(woke_ns=time.monotonic_ns() - 3_000_000_000)
        self.assertIsNotNone(self.poll())
        self.assertIsNone(self.poll())
        self.assertIn("suspended", self.link.state)
        writer.publish()
        self.poll()
        self.assertEqual(self.link.state, "Connected to the run clay")

    def test_another_generation_is_another_content(self):
        writer = self.writer().create()
        writer.publish()
        self.poll()
        writer.put(SETUP, "Q", 5)
        writer.publish()
        self.assertIsNone(self.poll())
        writer.put(SETUP, "2Q", 6, 2)
        writer.generation = 2
        number = writer.publish()
        self.assertEqual((self.poll().number, self.link.epoch), (number, 2))

    def test_the_rate_is_that_of_the_ticks(self):
        writer = self.writer().create()
        for tick in range(250):
            writer.publish(woke_ns=10_000_000 * tick)
            self.poll()
        self.assertAlmostEqual(self.link.rate_hz, 100.0, delta=2.0)

    def test_a_closed_link_leaves_no_open_file(self):
        def open_files():
            links = (f"/proc/self/fd/{each}" for each in os.listdir("/proc/self/fd"))
            return sum(os.path.lexists(each) and self.folder in os.readlink(each) for each in links)
        writer = self.writer().create()
        writer.publish()
        before = open_files()
        self.poll()
        self.assertEqual(open_files(), before + 1)
        self.link.close()
        self.assertEqual(open_files(), before)


if __name__ == "__main__":
    unittest.main()
