import json
import threading
import time
import unittest

import numpy as np

import nendo
from fixtures import LONG, TestCase, hold_gil, run_python, seconds_after_interrupt


class Gloves(TestCase):
    def test_samples_come_in_order_without_gaps(self):
        with nendo.open("sim:wave?rate=200", side="left") as glove:
            self.assertEqual((glove.info.side, glove.info.kind, glove.info.rate_hz), ("left", "simulated", 200))
            samples = np.concatenate([glove.read(timeout=1), glove.read(timeout=1), glove.read(timeout=1)])
        samples = np.concatenate([samples, glove.read()])
        self.assertEqual(samples.dtype, nendo.sample_dtype)
        np.testing.assert_array_equal(samples["sequence"], np.arange(len(samples)))
        self.assertTrue((np.diff(samples["time_s"]) > 0).all())
        self.assertTrue((samples["arrival_s"] <= time.monotonic()).all())
        names = [nendo.SENSOR_NAMES[k] for k in np.flatnonzero(samples["present"][0])]
        self.assertEqual(tuple(names), glove.info.sensors)
        self.assertTrue((samples["side"] == 0).all())

    def test_read_waits_only_for_its_timeout(self):
        with nendo.open("sim?rate=1") as glove:
            glove.read(timeout=5)
            began = time.monotonic()
            glove.read()
            self.assertLess(time.monotonic() - began, 0.05)
            self.assertEqual(len(glove.read(timeout=0.2)), 0)
            self.assertGreaterEqual(time.monotonic() - began, 0.2)
            self.assertEqual(len(glove.read(timeout=5)), 1)
        for wrong in (-1.0, float("nan")):
            with self.assertRaises(ValueError):
                glove.read(timeout=wrong)

    def test_busy_python_loses_no_sample(self):
        seconds = 3 * LONG
        with nendo.open("sim:grasp?rate=500") as glove:
            end, parts = time.monotonic() + seconds, []
            while time.monotonic() < end:
                hold_gil(0.5)
                parts.append(glove.read())
        samples = np.concatenate([*parts, glove.read()])
        stats = glove.stats
        self.assertEqual((stats["dropped"], stats["refused"]), (0, 0))
        self.assertEqual(len(samples), stats["records"])
        np.testing.assert_array_equal(np.diff(samples["sequence"]), 1)
        self.assertGreater(len(samples), 0.3 * 500 * seconds)

    def test_a_full_queue_drops_the_oldest_samples_and_counts_them(self):
        with nendo.open("sim?rate=500", capacity=10) as glove:
            time.sleep(0.5)
        samples = glove.read()
        self.assertEqual(len(samples), 10)
        self.assertEqual(glove.stats["dropped"], samples["sequence"][0])
        self.assertEqual(glove.stats["records"], samples["sequence"][-1] + 1)

    def test_hands_are_those_of_the_program(self):
        self.run_nendo("record", "sim:grasp", "--duration", "1s", "--out", "take.nendo")
        spec = f"replay:{self.folder}/take.nendo?speed=20"
        lines = [json.loads(line) for line in self.run_nendo("poses", spec).splitlines()]
        take = nendo.Recording(self.folder / "take.nendo")
        samples, calibration = take.samples(), take.calibration()
        angles = calibration.joint_angles(samples)
        poses = calibration.skeleton().pose(angles)
        self.assertEqual(poses.shape, (len(lines), 26, 4, 4))
        for pose, line in zip(poses, lines):
            shown = np.array([line["joints"][name]["position_m"] for name in nendo.JOINT_NAMES])
            self.assert_same(np.ascontiguousarray(pose[:, :3, 3]), shown)
        with nendo.open(spec) as glove:
            self.assertEqual(glove.info.kind, "recorded")
            hands = list(glove)  # a hand may pass over samples that came together
        self.assertEqual(hands[-1].sequence, samples["sequence"][-1])
        for hand in hands:
            at = np.flatnonzero(samples["sequence"] == hand.sequence)[0]
            self.assert_same(hand.angles, angles[at].copy())
            self.assert_same(hand.joints, poses[at].copy())

    def test_reading_before_start_is_an_error(self):
        glove = nendo.open("sim")
        for call in (glove.read, glove.__next__):
            with self.assertRaisesRegex(nendo.Error, "start"):
                call()
        glove.close()
        with self.assertRaisesRegex(nendo.Error, "closed"):
            glove.start()

    def test_errors_have_codes_and_kinds(self):
        for spec, kind, code in (("serial:/nowhere", FileNotFoundError, "no_device"), ("abacus:1", nendo.Error, "usage"),
                                 ("sim:dance", nendo.Error, "usage")):
            with self.assertRaises(kind) as caught:
                nendo.open(spec)
            self.assertIsInstance(caught.exception, nendo.Error)
            self.assertEqual(caught.exception.code, code)
        with self.assertRaises(nendo.Error):
            nendo.open("sim", user="unknown wearer")
        with self.assertRaises(ValueError):
            nendo.open("sim", side="both")
        with self.assertRaises(ValueError):
            nendo.open("sim", capacity=0)
        self.assertIsInstance(nendo.devices(), list)

    def test_another_thread_may_close_a_glove_that_is_read(self):
        glove = nendo.open("sim?rate=1")
        glove.start()
        glove.read(timeout=5)
        threading.Timer(0.2, glove.close).start()
        began = time.monotonic()
        self.assertLessEqual(len(glove.read(timeout=20)), 1)
        self.assertLess(time.monotonic() - began, 5)

    def test_ctrl_c_ends_waits(self):
        for wait in ("print('waits'); glove.read(timeout=60)", "print('waits'); [None for _ in glove]"):
            code = "glove = nendo.open('sim?rate=1')\nglove.start()\nglove.read(timeout=5)\n" + wait
            self.assertLess(seconds_after_interrupt(code), 0.2)

    def test_python_ends_with_open_gloves(self):
        child = run_python("""
            import threading, nendo
            glove, session = nendo.open("sim?rate=500"), nendo.open_tracker("sim:orbit")
            glove.start(); session.start()
            circle = [glove]; circle.append(circle)
            threading.Thread(target=lambda: glove.read(timeout=100), daemon=True).start()
        """)
        self.assertEqual((child.wait(timeout=30), child.communicate()[1]), (0, ""))


class Trackers(TestCase):
    def test_poses_come_in_order(self):
        with nendo.open_tracker("sim:orbit") as tracker:
            poses = np.concatenate([tracker.read(timeout=2), tracker.read(timeout=2)])
        self.assertEqual(poses.dtype, nendo.pose_dtype)
        np.testing.assert_array_equal(np.diff(poses["sequence"]), 1)
        self.assert_near(np.linalg.norm(poses["turn_xyzw"], axis=1), np.ones(len(poses)), 1e-9)
        self.assertGreaterEqual(tracker.stats["records"], len(poses))
        with self.assertRaises(nendo.Error):
            nendo.open_tracker("abacus:1")


if __name__ == "__main__":
    unittest.main()
