"""Writes segments byte for byte by apps/publish/FORMAT.md, as a run of nendo does, for tests of their reader."""
import fcntl
import os
import struct
import time

import numpy as np

LIVE, ENDED = 1, 2
SETUP, RADII = 192, 320
F_OFD_SETLK = 37
TETRAHEDRON = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]


def joints_of(number):
    """(2, 26, 7): other joints for each record, with unit quaternions."""
    random = np.random.default_rng(number)
    joints = random.normal(size=(2, 26, 7))
    joints[..., 3:] /= np.linalg.norm(joints[..., 3:], axis=-1, keepdims=True)
    return joints.astype(np.float32)


def floats_of(number, vertices):
    """(n, 3): other vertices for each record."""
    return np.random.default_rng(1000 + number).normal(size=(vertices, 3)).astype(np.float32)


class Writer:
    """A segment of a tetrahedron, or of other triangles, with no record at first. `header` replaces fields of its header."""

    def __init__(self, folder, name, triangles=TETRAHEDRON, vertices=4, slots=8, shape_slots=4, minor=2, generation=1, header=()):
        self.path, self.vertices, self.slots, self.shape_slots = os.path.join(folder, "nendo-" + name), vertices, slots, shape_slots
        self.triangles = np.array(triangles, np.uint32).reshape(-1, 3)
        self.origin, self.unit, self.offset, self.upm = np.array([1.0, 2.0, 3.0]), 0.5, np.array([10.0, 0.0, 0.0]), 2.0
        line = lambda size: (size + 63) // 64 * 64
        self.faces = line(RADII + 208)
        rest = line(self.faces + self.triangles.nbytes)
        self.records = line(rest + 12 * vertices)
        self.stride = 1664
        self.shapes = self.records + slots * self.stride
        self.shape_stride = line(64 + 12 * vertices)
        length = self.shapes + shape_slots * self.shape_stride
        self.bytes = bytearray(length)
        fields = {
            "magic": (0, "8s", b"NENDOPUB"), "order": (8, "I", 0x01020304), "major": (12, "H", 1), "minor": (14, "H", minor),
            "length": (16, "Q", length), "vertices": (28, "I", vertices), "triangles": (32, "I", len(self.triangles)),
            "record_slots": (36, "I", slots), "shape_slots": (40, "I", shape_slots), "setup": (48, "Q", SETUP),
            "faces": (56, "Q", self.faces), "rest": (64, "Q", rest), "records": (72, "Q", self.records),
            "record_stride": (80, "Q", self.stride), "shapes": (88, "Q", self.shapes),
            "shape_stride": (96, "Q", self.shape_stride), "state": (128, "I", LIVE), "newest": (136, "Q", 0)}
        wrong = dict(header)
        for key, (at, form, value) in fields.items():
            struct.pack_into("=" + form, self.bytes, at, wrong.pop(key, value))
        assert not wrong
        struct.pack_into("=2Q6d2I3d", self.bytes, SETUP, 2 * generation + 2, generation, *self.origin, self.unit, 90.0, self.upm, 1,
                         RADII, *self.offset)
        self.generation = generation
        self.bytes[RADII:RADII + 208] = np.full(52, 0.008, np.float32).tobytes()
        self.bytes[self.faces:self.faces + self.triangles.nbytes] = self.triangles.tobytes()
        self._file, self.number = None, 0

    def create(self, locked=True):
        """Gives the file its name."""
        part = self.path + ".part"
        self._file = open(part, "w+b", buffering=0)
        self._file.write(self.bytes)
        if locked:
            fcntl.fcntl(self._file, F_OFD_SETLK, struct.pack("hhqqi4x", fcntl.F_WRLCK, os.SEEK_SET, 0, 0, 0))
        os.replace(part, self.path)
        return self

    def put(self, at, form, *values):
        os.pwrite(self._file.fileno(), struct.pack("=" + form, *values), at)

    def publish(self, joints=None, floats=None, changes=None, woke_ns=None, present=3):
        """Writes the next record, and its shape."""
        self.number += 1
        number = self.number
        joints = joints_of(number) if joints is None else joints
        floats = floats_of(number, self.vertices) if floats is None else floats
        changes = number if changes is None else changes
        woke_ns = time.monotonic_ns() if woke_ns is None else woke_ns
        shape = self.shapes + number % self.shape_slots * self.shape_stride
        os.pwrite(self._file.fileno(), floats.tobytes(), shape + 64)
        self.put(shape, "3Q", 2 * number + 2, number, changes)
        record = self.records + number % self.slots * self.stride
        head = struct.pack("=8Q3qQd4IQ", 2 * number + 2, number, self.generation, number + 6, number, 0, 0, 0, woke_ns, woke_ns, 0,
                           changes, self.upm, 1, 0, 1, 0, 0)
        hands = b"".join(struct.pack("=2IQ", present >> side & 1, 0, number) + joints[side].tobytes() for side in (0, 1))
        os.pwrite(self._file.fileno(), head + hands, record)
        self.put(144, "q", woke_ns)
        self.put(136, "Q", number)
        return number

    def model(self, number):
        """(n, 3): where the vertices of this record are, in the units of the model's file."""
        return self.offset + self.origin + self.unit * floats_of(number, self.vertices).astype(float)

    def end(self):
        """As a run that ends."""
        self.put(128, "I", ENDED)
        self.close()
        os.unlink(self.path)

    def close(self):
        """As a run that is killed."""
        if self._file:
            self._file.close()
            self._file = None
