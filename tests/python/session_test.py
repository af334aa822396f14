import time
import unittest

import numpy as np

import nendo
from fixtures import MOAI, TestCase, hold_gil, run_python, seconds_after_interrupt


class Sessions(TestCase):
    def test_frames_follow_each_other_and_the_shape_changes(self):
        mesh = nendo.Mesh.read(MOAI)
        with nendo.Session(mesh, left="sim:sculpt", right="sim:sculpt") as session:
            frames = [frame for frame, _ in zip(session, range(60))]
            shape = session.vertices
            self.assert_same(session.faces, mesh.faces)
            self.assertEqual([glove.side for glove in session.gloves], ["left", "right"])
        numbers = [frame.number for frame in frames]
        self.assertEqual(numbers, sorted(set(numbers)))
        self.assertTrue(all(frame.present.all() and not frame.silent.any() for frame in frames))
        self.assertLess(frames[-1].time_s, time.monotonic())
        self.assert_near(np.linalg.norm(frames[-1].hands[..., 3:], axis=-1), np.ones((2, 26)), 1e-12)
        self.assertGreater(np.abs(shape - mesh.vertices).max(), 0.01)
        out = session.finish()
        self.assert_same(out.face_corners, mesh.face_corners)
        self.assert_same(session.vertices, out.vertices)
        self.assertEqual((session.stats["ticks"] >= 60, list(session)), (True, []))
        with self.assertRaises(nendo.Error):
            session.ask("undo")

    def test_requests_and_settings_reach_the_loop(self):
        with nendo.Session(MOAI, right="sim:sculpt", radius_m=0.05) as session:
            next(session)
            self.assertEqual(session.frame().present.tolist(), [False, True])
            self.assertTrue(np.isnan(session.frame().hands[0]).all())
            self.assertEqual(session.settings["radius_m"], [0.05] * 5)
            session.change(mode="type2", radius_m=[0.04, 0.05, 0.05, 0.05, 0.06], kernel="wendland-c4", injective=False)
            self.assertEqual((session.settings["mode"], session.settings["radius_m"][4]), ("type2", 0.06))
            session.ask("release")
            self.assertTrue(self.eventually(lambda: not session.frame().held))
            wrist = np.eye(4)
            wrist[:3, 3] = 1, 2, 3
            session.move_wrist("right", wrist)
            self.assertTrue(self.eventually(lambda: np.abs(session.frame().hands[1, 1, :3] - [1, 2, 3]).max() < 1e-9))
            session.ask("reset")
            self.assertTrue(self.eventually(lambda: np.array_equal(session.vertices, nendo.Mesh.read(MOAI).vertices)))
            for wrong, kind in (({"mode": "type3"}, ValueError), ({"radius_m": -1.0}, nendo.Error), ({"colour": 1}, TypeError)):
                with self.assertRaises(kind):
                    session.change(**wrong)
            with self.assertRaises(ValueError):
                session.ask("dance")
            with self.assertRaises(ValueError):
                session.move_wrist("right", np.ones((4, 4)))

    def eventually(self, is_true):
        end = time.monotonic() + 5
        while time.monotonic() < end:
            if is_true():
                return True
            time.sleep(0.01)
        return False

    def test_busy_python_does_not_delay_the_loop(self):
        with nendo.Session(MOAI, left="sim", right="sim", rate_hz=200.0) as session:
            first = next(session)
            began = time.monotonic()
            hold_gil(2)
            last = session.frame()
            elapsed = time.monotonic() - began
            self.assertLess(began + elapsed - last.time_s, 0.5)  # a loop that waits for Python would be two seconds late
        self.assertGreater(last.number - first.number, 0.6 * 200 * elapsed)

    def test_an_ended_recording_ends_the_iteration(self):
        self.run_nendo("record", "sim:grasp", "--duration", "1s", "--out", "take.nendo")
        with nendo.Session(MOAI, right=f"replay:{self.folder}/take.nendo") as session:
            frames = list(session)
        self.assertGreater(len(frames), 20)

    def test_errors_and_ctrl_c(self):
        for wrong, kind in (({"left": "abacus:1"}, nendo.Error), ({"mode": "type3"}, ValueError),
                            ({"left": "sim", "rate_hz": 0.0}, nendo.Error), ({"left": "sim", "radius_m": float("nan")}, nendo.Error)):
            with self.assertRaises(kind):
                nendo.Session(MOAI, **wrong)
        with self.assertRaises(FileNotFoundError):
            nendo.Session(self.folder / "none.obj")
        code = "session = nendo.Session(sys.argv[1], left='sim?rate=1')\nnext(session)\nsession.ask('release')\nprint('waits')\n"
        self.assertLess(seconds_after_interrupt(code + "for _ in session: pass", MOAI), 0.2)

    def test_python_ends_with_a_running_session(self):
        child = run_python("""
            import sys, nendo
            session = nendo.Session(sys.argv[1], left="sim", right="sim")
            circle = [session]; circle.append(circle)
        """, MOAI)
        self.assertEqual((child.wait(timeout=60), child.communicate()[1]), (0, ""))


if __name__ == "__main__":
    unittest.main()
