"""Follows a run by its name: waits for it, reads it, and finds it again when it restarts or its model changes. Needs nothing of
Blender."""
import time

from . import segment as segments

RETRY_S = 0.25  # between two looks for a run that is not there
SILENT_NS = 1_000_000_000


class Content:
    """What does not change while the model stays the same."""

    def __init__(self, setup, triangles, radii_m, vertices):
        self.setup, self.triangles, self.radii_m, self.vertices = setup, triangles, radii_m, vertices


class Link:
    """A connection to the run NAME, which messages call `label`. poll() never blocks. `epoch` grows when `content` is another one."""

    def __init__(self, name, folder=segments.FOLDER, clock=time.monotonic, label=""):
        self.label = label or f"the run {name}"
        self.name, self.epoch, self.content, self.state = name, 0, None, "Connecting"
        self.rate_hz = 0.0
        self._folder, self._clock = folder, clock
        self._segment, self._retry_at = None, 0.0
        self._over = False      # the run of the segment no longer lives
        self._is_other = False  # the content of the segment was not read yet
        self._first = None  # number and time of the record from which rate_hz counts
        self._last = 0

    def close(self):
        if self._segment:
            self._segment.close()
        self._segment = None

    def poll(self):
        """The newest Frame, or None if there is no new one. Errors are in `state`."""
        try:
            return self._poll()
        except segments.SegmentError as error:
            self._drop(str(error))
        except OSError as error:
            self._drop(f"{self.name}: {error.strerror or error}")
        return None

    def frames(self, after):
        """All frames after this number that the segment still has, in order."""
        if not self._segment:
            return []
        newest = self._segment.newest()
        if newest < after:
            return []
        numbers = range(max(after + 1, self._segment.oldest(newest)), newest + 1)
        found = (self._segment.frame(number) for number in numbers)
        return [frame for frame in found if frame is not None and frame.generation == self.content.setup.generation]

    def shape(self, frame):
        """The floats of the vertices at this frame, (n, 3) float32 that the next call overwrites, or None if it is too late."""
        return self._segment.shape(frame.number, self.content.setup) if self._segment else None

    def current(self):
        """The newest Frame and a copy of its shape, also of a run that has ended; (None, None) if there is none."""
        for _ in range(20 if self._segment and self.content else 0):
            frame = self._segment.frame(self._segment.newest())
            if frame is None or frame.generation != self.content.setup.generation:
                continue
            floats = self.shape(frame)
            if floats is not None:
                return frame, floats.copy()
        return None, None

    def _drop(self, reason):
        self.close()
        self._over, self.rate_hz = False, 0.0
        self._retry_at = self._clock() + RETRY_S
        self.state = reason

    def _poll(self):
        if self._segment is None or self._over:
            self._look_for_run()
        if self._segment is None:
            return None
        is_new_content = self.content is None or not self._segment.is_of(self.content.setup) or self._is_other
        if is_new_content and not self._take_content():
            return None
        frame = self._newest()
        if not self._over:
            self._judge(frame)
        return frame

    def _look_for_run(self):
        """A run that has ended stays readable until another one has its name."""
        if self._clock() < self._retry_at:
            return
        self._retry_at = self._clock() + RETRY_S
        try:
            found = segments.open_segment(self.name, self._folder)
        except FileNotFoundError:
            if self._segment is None:
                self.state = f"Waiting for: nendo run --to shm:{self.name}"
            return
        if self._segment and found.identity == self._segment.identity:
            found.close()
            return
        self.close()
        self._segment, self._over, self._is_other = found, False, True
        self._last, self._first, self.rate_hz = 0, None, 0.0

    def _take_content(self):
        setup = self._segment.setup()
        triangles = self._segment.triangles(setup) if setup else None
        radii = self._segment.radii_m(setup) if setup else None
        if triangles is None or radii is None:
            return False
        self.content = Content(setup, triangles, radii, self._segment.vertices)
        self.epoch += 1
        self._is_other = False
        return True

    def _newest(self):
        for _ in range(3):  # the writer may overtake the reader
            number = self._segment.newest()
            if number == self._last:
                return None
            frame = self._segment.frame(number)
            if frame is None or frame.generation != self.content.setup.generation:
                continue
            self._last = frame.number
            self._count(frame)
            return frame
        return None

    def _count(self, frame):
        if self._first is None:
            self._first = (frame.number, frame.woke_ns)
        passed_s = (frame.woke_ns - self._first[1]) / 1e9
        if passed_s >= 1.0:
            self.rate_hz = (frame.number - self._first[0]) / passed_s
            self._first = (frame.number, frame.woke_ns)

    def _about(self, what):
        return f"{self.label[0].upper()}{self.label[1:]} {what}"

    def _judge(self, frame):
        life = self._segment.life()
        if life != segments.RUNS:
            self._over = True
            self.rate_hz = 0.0
            how = "has ended" if life == segments.ENDED else "was killed"
            self.state = self._about(f"{how}. Waiting for the next one")
        elif self._segment.newest() == 0:
            self.state = self._about("begins")
        elif frame is None and time.monotonic_ns() - self._segment.heartbeat_ns() > SILENT_NS:
            self.rate_hz = 0.0
            self.state = self._about("is suspended")
        elif frame is not None:
            self.state = f"Connected to {self.label}"
