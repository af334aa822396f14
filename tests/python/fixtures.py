"""What the tests of the Python module share. NENDO_PROGRAM is the program nendo, NENDO_MODELS its models; NENDO_LONG multiplies
the lengths of the tests that repeat much."""
import os
import pathlib
import signal
import struct
import subprocess
import sys
import tempfile
import textwrap
import time
import unittest

import numpy as np

import nendo

PROGRAM = os.environ.get("NENDO_PROGRAM", "nendo")
MODELS = pathlib.Path(os.environ.get("NENDO_MODELS", "/usr/share/nendo/models"))
LONG = float(os.environ.get("NENDO_LONG", "1"))
MOAI = MODELS / "moai.obj"


class TestCase(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_nendo(self, *arguments):
        done = subprocess.run([PROGRAM, *map(str, arguments)], cwd=self.folder, capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def assert_same(self, one, other):
        """Bit for bit."""
        self.assertEqual((one.shape, one.dtype), (other.shape, other.dtype))
        self.assertEqual(one.tobytes(), other.tobytes())

    def assert_near(self, one, other, tolerance):
        self.assertEqual(np.shape(one), np.shape(other))
        self.assertLessEqual(np.abs(np.asarray(one) - other).max(initial=0), tolerance)


def run_python(code, *arguments, **options):
    """Starts another Python with this code, and the test's modules."""
    return subprocess.Popen([sys.executable, "-c", textwrap.dedent(code), *map(str, arguments)], stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True, **options)


def seconds_after_interrupt(code, *arguments):
    """Runs code that prints "waits" and then waits, sends it a Ctrl-C, and returns after how many seconds it was raised."""
    body = textwrap.indent(textwrap.dedent(code), "    ")
    # A parent in the background, as of a script, may ignore Ctrl-C, and its children too.
    heeds = "signal.signal(signal.SIGINT, signal.default_int_handler)"
    script = (f"import signal, sys, time, nendo\n{heeds}\ntry:\n{body}\n"
              "except KeyboardInterrupt:\n    print(time.monotonic())\n")
    with subprocess.Popen([sys.executable, "-u", "-c", script, *map(str, arguments)], stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout.readline() == "waits\n"
        time.sleep(0.3)
        sent = time.monotonic()
        child.send_signal(signal.SIGINT)
        raised = float(child.stdout.readline())
        assert child.wait(timeout=30) == 0
        return raised - sent


def hold_gil(seconds):
    """Computes in one call of C, which never gives the GIL away."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        sum(range(3_000_000))


def ball(radius=1.0, rings=16, corners=24, centre=(0.0, 0.0, 0.0)):
    """A closed mesh of a sphere: vertices and triangles."""
    polar = np.pi * np.arange(1, rings) / rings
    around = 2 * np.pi * np.arange(corners) / corners
    grid = np.stack([np.outer(np.sin(polar), np.sin(around)), np.outer(np.cos(polar), np.ones(corners)),
                     np.outer(np.sin(polar), np.cos(around))], axis=-1).reshape(-1, 3)
    vertices = np.concatenate([grid, [[0, 1, 0], [0, -1, 0]]]) * radius + centre
    faces, top, bottom = [], len(grid), len(grid) + 1
    for k in range(corners):
        after = (k + 1) % corners
        faces += [(top, k, after), (bottom, (rings - 2) * corners + after, (rings - 2) * corners + k)]
        for ring in range(rings - 2):
            a, b = ring * corners + k, ring * corners + after
            faces += [(a, a + corners, b), (b, a + corners, b + corners)]
    return np.ascontiguousarray(vertices), np.array(faces, np.int32)


def volume(vertices, faces):
    a, b, c = (vertices[faces[:, k].astype(int)] for k in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6
