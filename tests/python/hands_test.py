import unittest

import numpy as np

import nendo
from fixtures import TestCase

ANGLE = {name: k for k, name in enumerate(nendo.ANGLE_NAMES)}
JOINT = {name: k for k, name in enumerate(nendo.JOINT_NAMES)}
SENSOR = {name: k for k, name in enumerate(nendo.SENSOR_NAMES)}


def samples_of(counts, side="right", count=20):
    samples = np.zeros(count, nendo.sample_dtype)
    samples["counts"] = np.round(counts)
    samples["present"] = np.isin(nendo.SENSOR_NAMES, ("index_abduction", "unused"), invert=True)
    samples["side"] = side == "right"
    samples["device_s"] = np.nan
    samples["sequence"] = np.arange(count)
    return samples


class Hands(TestCase):
    def setUp(self):
        super().setUp()
        self.random = np.random.default_rng(1)
        low, high = nendo.ANGLE_LIMITS_RAD.T
        self.angles = self.random.uniform(low, high, (50, 23))

    def test_names_have_the_order_of_openxr(self):
        self.assertEqual((len(nendo.JOINT_NAMES), len(nendo.ANGLE_NAMES), len(nendo.SENSOR_NAMES)), (26, 23, 24))
        self.assertEqual((JOINT["palm"], JOINT["wrist"], JOINT["thumb_tip"], JOINT["index_tip"], JOINT["little_tip"]),
                         (0, 1, 5, 10, 25))
        self.assertEqual([k for k, parent in enumerate(nendo.JOINT_PARENTS) if parent < 0], [JOINT["wrist"]])

    def test_bones_keep_their_lengths_and_poses_are_rigid(self):
        for side in ("left", "right"):
            poses = nendo.HandSkeleton(side).pose(self.angles)
            turns, places = poses[..., :3, :3], poses[..., :3, 3]
            self.assert_near(turns @ np.swapaxes(turns, -1, -2), np.broadcast_to(np.eye(3), turns.shape), 1e-12)
            bones = [k for k, parent in enumerate(nendo.JOINT_PARENTS) if parent >= 0 and k != JOINT["palm"]]
            parents = [nendo.JOINT_PARENTS[k] for k in bones]
            lengths = np.linalg.norm(places[:, bones] - places[:, parents], axis=-1)
            self.assert_near(lengths, np.broadcast_to(lengths[0], lengths.shape), 1e-12)

    def test_a_joint_turns_by_its_angle(self):
        skeleton = nendo.HandSkeleton("right", length_m=0.2, breadth_m=0.09)
        self.assertEqual((skeleton.side, skeleton.length_m, skeleton.breadth_m), ("right", 0.2, 0.09))
        for name, parent, joint in (("index_pip_flexion", "index_proximal", "index_intermediate"),
                                    ("ring_dip_flexion", "ring_intermediate", "ring_distal")):
            angles = np.zeros(23)
            angles[ANGLE[name]] = 0.7
            pose = skeleton.pose(angles)
            turn = pose[JOINT[parent], :3, :3].T @ pose[JOINT[joint], :3, :3]
            self.assertAlmostEqual(np.arccos((np.trace(turn) - 1) / 2), 0.7, delta=1e-9)
        middle = skeleton.pose(np.zeros(23))[JOINT["middle_tip"], :3, 3]
        self.assertLess(middle[2], -0.15)  # -z points to the fingertips

    def test_many_poses_are_those_of_one_at_a_time_and_move_with_the_wrist(self):
        skeleton, wrist = nendo.HandSkeleton("left"), np.eye(4)
        wrist[:3, :3] = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
        wrist[:3, 3] = 1, 2, 3
        poses = skeleton.pose(self.angles)
        for angles, pose in zip(self.angles, poses):
            self.assert_same(skeleton.pose(angles), pose.copy())
            self.assert_near(skeleton.pose(angles, wrist), wrist @ pose, 1e-12)

    def test_sensors_are_lines(self):
        average = nendo.Calibration.average()
        counts = np.round(average.offsets_counts + 20)
        angles = average.joint_angles(samples_of(counts))[0]
        expected = average.gains_rad_per_count * (counts - average.offsets_counts)
        for angle, sensor in (("index_mcp_flexion", "index_mcp"), ("ring_pip_flexion", "ring_pip"),
                              ("thumb_ip_flexion", "thumb_ip")):
            self.assertAlmostEqual(angles[ANGLE[angle]], expected[SENSOR[sensor]], delta=1e-12)

    def test_a_fit_finds_the_wearer(self):
        average = nendo.Calibration.average()
        gains, offsets = 1.15 * average.gains_rad_per_count, average.offsets_counts + 4
        flexion = np.array([name.endswith(("_mcp", "_pip", "_dip")) and "thumb" not in name for name in nendo.SENSOR_NAMES])
        bent = np.where([name.endswith("_pip") for name in nendo.SENSOR_NAMES], np.radians(100), np.radians(85))
        fist = np.where(flexion, offsets + bent / np.where(flexion, gains, 1), offsets)
        poses = {"flat": samples_of(offsets), "fist": samples_of(np.clip(fist, 1, 250))}
        fitted = nendo.Calibration.fit(poses.items(), side="right", mode="quick", user="anna")
        self.assertEqual((fitted.user, fitted.side, fitted.method), ("anna", "right", "quick"))
        flat = fitted.joint_angles(poses["flat"])[0]
        before = average.joint_angles(poses["flat"])[0]
        fingers = [k for name, k in ANGLE.items() if name.endswith("flexion") and "thumb" not in name]
        self.assertLess(np.abs(flat[fingers]).max(), 0.5 * np.abs(before[fingers]).max())
        for name in ("index_pip_flexion", "ring_pip_flexion"):
            self.assertAlmostEqual(fitted.joint_angles(poses["fist"])[0, ANGLE[name]], np.radians(100), delta=0.2)
        with self.assertRaises(nendo.Error):
            nendo.Calibration.fit([("flat", poses["flat"])], side="right")
        with self.assertRaisesRegex(ValueError, "no such pose"):
            nendo.Calibration.fit([("wave", poses["flat"])], side="right")

    def test_a_saved_calibration_is_read_by_the_program(self):
        path = nendo.Calibration.average("left", user="anna").save(self.folder / "left.toml")
        again = nendo.Calibration.load(path)
        self.assert_same(again.gains_rad_per_count, nendo.Calibration.average("left").gains_rad_per_count)
        self.assertEqual((again.side, again.path), ("left", str(path)))
        with nendo.open("sim", side="left", calibration=str(path)) as glove:
            self.assert_same(glove.calibration.offsets_counts, again.offsets_counts)
        self.run_nendo("monitor", "sim?hand=left", "--calibration", path, "--count", "1")
        with self.assertRaises(FileNotFoundError):
            nendo.Calibration.load(self.folder / "none.toml")
        (self.folder / "bad.toml").write_text("user = [")
        with self.assertRaises(nendo.Error) as caught:
            nendo.Calibration.load(self.folder / "bad.toml")
        self.assertEqual(caught.exception.code, "bad_input")


if __name__ == "__main__":
    unittest.main()
