import os
import pathlib
import subprocess
import sys
import time
import unittest

import nendo
from fixtures import MOAI, PROGRAM, TestCase

EXAMPLES = pathlib.Path(os.environ.get("NENDO_EXAMPLES", "/usr/share/doc/python3-nendo/examples"))


class Examples(TestCase):
    def run_example(self, name, *arguments):
        done = subprocess.run([sys.executable, EXAMPLES / name, *map(str, arguments)], cwd=self.folder, capture_output=True,
                              text=True, timeout=60)
        self.assertEqual((done.returncode, done.stderr), (0, ""), name)
        return done.stdout

    def test_there_are_six_and_each_is_run_here(self):
        tested = {"read_glove.py", "hand_pose.py", "deform_mesh.py", "live_loop.py", "recording_arrays.py", "attach_run.py"}
        self.assertEqual({path.name for path in EXAMPLES.glob("*.py")}, tested)

    def test_read_glove(self):
        self.assertIn("index_pip", self.run_example("read_glove.py", "sim:wave"))

    def test_hand_pose(self):
        self.assertIn("index", self.run_example("hand_pose.py", "sim:grasp"))

    def test_deform_mesh(self):
        self.run_example("deform_mesh.py", MOAI, "out.ply")
        before, after = nendo.Mesh.read(MOAI).vertices, nendo.Mesh.read(self.folder / "out.ply").vertices
        self.assertGreater(abs(after - before).max(), 0.05)

    def test_live_loop(self):
        self.run_example("live_loop.py", MOAI, "out.ply", "sim:sculpt", "sim:sculpt")
        self.assertEqual(len(nendo.Mesh.read(self.folder / "out.ply").vertices), len(nendo.Mesh.read(MOAI).vertices))

    def test_recording_arrays(self):
        self.run_nendo("run", MOAI, "--left", "sim:sculpt", "--right", "sim:sculpt", "--duration", "1", "--out", "out.ply",
                       "--record", "take.nendo")
        self.assertIn("ticks", self.run_example("recording_arrays.py", "take.nendo"))

    def test_attach_run(self):
        name = f"example-{os.getpid()}"
        arguments = ["run", MOAI, "--right", "sim", "--duration", "4", "--out", "out.ply", "--to", f"shm:{name}"]
        with subprocess.Popen([PROGRAM, *map(str, arguments)], cwd=self.folder, stdout=subprocess.DEVNULL) as program:
            while not pathlib.Path(f"/dev/shm/nendo-{name}").exists() and program.poll() is None:
                time.sleep(0.01)
            self.assertIn("m", self.run_example("attach_run.py", name))
            self.assertEqual(program.wait(timeout=30), 0)


if __name__ == "__main__":
    unittest.main()
