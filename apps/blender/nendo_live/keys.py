"""What a recording keeps: the ticks that are nearest to the frames of the scene, and a point cache. Needs nothing of Blender."""
import os
import struct

import numpy as np


class Sampler:
    """Chooses for each whole frame the item that is nearest to it in time."""

    def __init__(self, rate_hz):
        self.rate_hz = rate_hz
        self._begin = None
        self._previous = None  # its position in frames, and the item
        self._next = 0

    def feed(self, time_ns, item):
        """Takes an item later than the previous one; returns (frame, item) for all frames that are decided now, from 0."""
        if self._begin is None:
            self._begin = time_ns
        position = (time_ns - self._begin) / 1e9 * self.rate_hz
        chosen = []
        while self._next <= position:
            is_nearer = self._previous is not None and self._next - self._previous[0] < position - self._next
            chosen.append((self._next, self._previous[1] if is_nearer else item))
            self._next += 1
        self._previous = (position, item)
        return chosen


class PointCache:
    """A PC2 file that grows by one frame after another."""

    HEAD = struct.Struct("<12s2i2fi")

    def __init__(self, path, vertices):
        self.path, self.frames, self._vertices = path, 0, vertices
        self._file = open(path, "wb")
        self._write_head()

    def _write_head(self):
        self._file.write(self.HEAD.pack(b"POINTCACHE2\0", 1, self._vertices, 0.0, 1.0, self.frames))

    def add(self, points):
        """Points (n, 3) float32. Raises OSError."""
        self._file.write(np.ascontiguousarray(points, "<f4").tobytes())
        self.frames += 1

    def finish(self):
        """Writes the number of frames. Raises OSError."""
        with self._file:
            self._file.seek(0)
            self._write_head()

    def discard(self):
        self._file.close()
        os.unlink(self.path)
