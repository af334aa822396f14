import csv
import json
import shutil
import unittest

import numpy as np

import nendo
from fixtures import MODELS, MOAI, TestCase


class Recordings(TestCase):
    def setUp(self):
        super().setUp()
        self.model = self.folder / "model.obj"
        shutil.copy(MOAI, self.model)

    def record(self, *options):
        self.run_nendo("run", self.model, "--left", "sim:sculpt", "--right", "sim:sculpt", "--duration", "1", "--out", "out.ply",
                       "--record", "take.nendo", *options)
        return nendo.Recording(self.folder / "take.nendo")

    def test_a_replay_makes_the_shape_of_then(self):
        take = self.record()
        self.assertEqual((take.setup["mode"], take.setup["rate_hz"], take.setup["model"]), ("type1", 90, str(self.model)))
        replay = take.replay()
        frames = list(replay)
        self.assertTrue(replay.is_exact)
        self.assert_same(replay.vertices, nendo.Mesh.read(self.folder / "out.ply").vertices)
        ticks = take.ticks()
        self.assertEqual(ticks.dtype, nendo.tick_dtype)
        self.assertEqual([frame.number for frame in frames], ticks["number"].tolist())
        self.assertEqual(take.summary()["ticks"], len(ticks))
        self.assertTrue(take.summary()["is_whole"])
        hands = take.hands(nendo.Mesh.read(self.model))
        self.assertEqual(hands.shape, (len(ticks), 2, 26, 7))
        self.assert_same(hands, np.stack([frame.hands for frame in frames]))

    def test_hands_are_those_of_an_export(self):
        take = self.record()
        self.run_nendo("export", "take.nendo", "--out", "take.csv")
        with open(self.folder / "take.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        hands, angles = take.hands(), np.stack([frame.angles for frame in take.replay()])
        for side, name in enumerate(("left", "right")):
            tips = np.array([[float(row[f"{name}_index_tip_{axis}_m"]) for axis in "xyz"] for row in rows])
            self.assert_near(hands[:, side, nendo.JOINT_NAMES.index("index_tip"), :3], tips, 1e-6)
            degrees = np.array([[float(row[f"{name}_{angle}_deg"]) for angle in nendo.ANGLE_NAMES] for row in rows])
            self.assert_near(np.degrees(angles[:, side]), degrees, 1e-3)
        self.assert_near(np.linalg.norm(hands[..., 3:], axis=-1), np.ones(hands.shape[:3]), 1e-12)

    def test_samples_are_those_of_the_gloves(self):
        take = self.record()
        summary = json.loads(self.run_nendo("recording", "info", "take.nendo", "--json"))
        self.assertEqual([glove.side for glove in take.gloves], ["left", "right"])
        for number, glove in enumerate(take.gloves):
            samples = take.samples(number)
            self.assertEqual(samples.dtype, nendo.sample_dtype)
            self.assertEqual(len(samples), summary["gloves"][number]["samples"])
            np.testing.assert_array_equal(samples["side"], number)
            with nendo.open(f"replay:{self.folder}/take.nendo?hand={glove.side}&speed=50") as again:
                parts = [again.read(timeout=5)]
                while len(parts[-1]):
                    parts.append(again.read(timeout=5))
            again = np.concatenate(parts)
            np.testing.assert_array_equal(again["counts"], samples["counts"])
            np.testing.assert_array_equal(again["sequence"], samples["sequence"])
        for wrong in (2, 10**9):
            with self.assertRaises(IndexError):
                take.samples(wrong)
        self.assertEqual(len(take.poses("left")), 0)

    def test_a_tracker_is_recorded(self):
        take = self.record("--right-wrist", "sim:orbit")
        poses = take.poses("right")
        self.assertGreater(len(poses), 30)
        self.assert_near(np.linalg.norm(poses["turn_xyzw"], axis=1), np.ones(len(poses)), 1e-9)

    def test_a_changed_model_is_noticed(self):
        take = self.record()
        shutil.copy(MODELS / "clay.ply", self.folder / "other.ply")
        nendo.Mesh.read(self.folder / "other.ply").write(self.model)
        with self.assertRaisesRegex(nendo.Error, "pass `model`"):
            take.replay()
        self.assertTrue(all(frame.held for frame in take.replay(nendo.Mesh.read(MOAI))))
        self.model.unlink()
        with self.assertRaises(FileNotFoundError):
            take.replay()

    def test_damaged_files_are_errors_or_gaps(self):
        take = self.folder / "take.nendo"
        self.record()
        whole = take.read_bytes()
        random = np.random.default_rng(3)
        for _ in range(100):
            data = bytearray(whole)
            for at in random.integers(0, len(data), 5):
                data[at] = random.integers(256)
            take.write_bytes(data[:random.integers(1, len(data))])
            try:
                damaged = nendo.Recording(take)
                self.assertGreaterEqual(damaged.summary()["ticks"], 0)
                self.assertLessEqual(sum(len(damaged.samples(k)) for k in range(len(damaged.gloves))), 400)
                list(damaged.replay())
            except nendo.Error as error:
                self.assertIn(error.code, ("bad_input", "failed"))
        with self.assertRaises(FileNotFoundError):
            nendo.Recording(self.folder / "none.nendo")


if __name__ == "__main__":
    unittest.main()
