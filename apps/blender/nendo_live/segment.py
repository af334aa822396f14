"""Reads the segment of `nendo run --to shm:NAME`, as apps/publish/FORMAT.md describes it. Needs NumPy, and nothing of Blender.

The file is read by pread() and never mapped: a writer that truncates it can then not end Blender by SIGBUS. Offsets and counts
are checked once, against the size of the file; the header is not read again, except for the words that change.
"""
import errno
import fcntl
import os
import platform
import stat
import struct

import numpy as np

FOLDER = "/dev/shm"
PREFIX = "nendo-"
MAJOR = 1
JOINTS = 26
MAX_VERTICES = 20_000_000
MAX_TRIANGLES = 2 * MAX_VERTICES
MAX_SLOTS = 1 << 20

# What a run does, as Segment.life() reports it.
RUNS, ENDED, KILLED = "runs", "ended", "killed"

_HEADER = np.dtype([
    ("magic", "S8"), ("byte_order", "=u4"), ("major", "=u2"), ("minor", "=u2"), ("segment_bytes", "=u8"), ("writer_pid", "=u4"),
    ("vertices", "=u4"), ("triangles", "=u4"), ("record_slots", "=u4"), ("shape_slots", "=u4"), ("states_stride", "=u4"),
    ("setup_offset", "=u8"), ("triangles_offset", "=u8"), ("rest_offset", "=u8"), ("records_offset", "=u8"),
    ("record_stride", "=u8"), ("shapes_offset", "=u8"), ("shape_stride", "=u8"), ("created_monotonic_ns", "=i8"),
    ("created_realtime_ns", "=i8"), ("states_offset", "=u8"), ("state", "=u4"), ("reserved", "=u4"), ("newest", "=u8"),
    ("heartbeat_ns", "=i8"), ("reserved3", "V40")])
_SETUP = np.dtype([
    ("stage", "=u8"), ("generation", "=u8"), ("origin", "=f8", 3), ("unit", "=f8"), ("rate_hz", "=f8"),
    ("units_per_metre", "=f8"), ("mode", "=u4"), ("radii_offset", "=u4"), ("offset", "=f8", 3), ("reserved", "V32")])
_HAND = np.dtype([("flags", "=u4"), ("reserved", "=u4"), ("samples", "=u8"), ("joints", "=f4", (JOINTS, 7))])
_RECORD = np.dtype([
    ("stage", "=u8"), ("number", "=u8"), ("generation", "=u8"), ("tick", "=u8"), ("ticks", "=u8"), ("missed", "=u8"),
    ("rest_changes", "=u8"), ("shape_jumps", "=u8"), ("scheduled_ns", "=i8"), ("woke_ns", "=i8"), ("since_last_ns", "=i8"),
    ("shape_changes", "=u8"), ("units_per_metre", "=f8"), ("flags", "=u4"), ("status", "=u4"), ("mode", "=u4"),
    ("fields", "=u4"), ("fields_bytes", "=u8"), ("hands", _HAND, 2)])
_SHAPE_BYTES = 64
assert (_HEADER.itemsize, _SETUP.itemsize, _RECORD.itemsize) == (192, 128, 1616)

_STATE_AT, _NEWEST_AT, _HEARTBEAT_AT = 128, 136, 144
_LIVE, _ENDED = 1, 2
_PRESENT, _SILENT = 1, 2
_FLOCK = "hhqqi4x"  # struct flock of Linux: type, whence, start, length, process


class SegmentError(Exception):
    """A segment that cannot be read. The message is one line for the user."""


class Setup:
    """What is the same for all records of a loop. Positions of the model are offset + origin + unit * float, in its units."""

    def __init__(self, raw):
        self.generation = int(raw["generation"])
        self.origin = np.array(raw["origin"], float)
        self.unit = float(raw["unit"])
        self.rate_hz = float(raw["rate_hz"])
        self.offset = np.array(raw["offset"], float)
        self.radii_offset = int(raw["radii_offset"])


class Frame:
    """One tick: joints (2, 26, 7) float32, left hand first, metres on the stage and quaternions x y z w."""

    def __init__(self, number, generation, tick, woke_ns, shape_changes, units_per_metre, flags, joints):
        self.number, self.generation, self.tick, self.woke_ns = number, generation, tick, woke_ns
        self.shape_changes, self.units_per_metre = shape_changes, units_per_metre
        self.present = tuple(bool(each & _PRESENT) for each in flags)
        self.silent = tuple(bool(each & _SILENT) for each in flags)
        self.joints = joints


def _fits(size, offset, count, each_bytes):
    return offset % 8 == 0 and offset + count * each_bytes <= size


class Segment:
    """An open segment. One thread at a time; no function blocks. Raises SegmentError; a damaged or overwritten record or shape is
    None."""

    def __init__(self, path):
        self.path = path
        self._file = _open(path)
        try:
            status = os.fstat(self._file)
            self.identity = (status.st_dev, status.st_ino)
            self._check(status)
        except BaseException:
            self.close()
            raise
        self._record = np.zeros((), _RECORD)
        self._floats = np.zeros(3 * self.vertices, np.float32)

    def close(self):
        if self._file is not None:
            os.close(self._file)
            self._file = None

    def _check(self, status):
        raw = os.pread(self._file, _HEADER.itemsize, 0) if stat.S_ISREG(status.st_mode) else b""
        if len(raw) < _HEADER.itemsize or raw[:8] != b"NENDOPUB":
            raise SegmentError(f"{self.path} is not a segment of Nendo")
        header = np.frombuffer(raw, _HEADER)[0]
        if header["byte_order"] != 0x01020304:
            raise SegmentError(f"{self.path} has the byte order of another machine")
        self.version = (int(header["major"]), int(header["minor"]))
        if self.version[0] != MAJOR:
            raise SegmentError(f"{self.path} has version {self.version[0]}, and this add-on reads version {MAJOR}: install the "
                               "add-on of the same Nendo")
        self._header = {name: int(header[name]) for name in _HEADER.names if _HEADER[name].kind in "ui"}
        head, size = self._header, status.st_size
        self.vertices, self.triangle_count = head["vertices"], head["triangles"]
        if self.vertices > MAX_VERTICES or self.triangle_count > MAX_TRIANGLES:
            raise SegmentError(f"{self.path} has more than {MAX_VERTICES:,} vertices")
        is_usable = (
            head["state"] != 0 and head["segment_bytes"] <= size and
            0 < head["record_slots"] <= MAX_SLOTS and 0 < head["shape_slots"] <= MAX_SLOTS and
            head["record_stride"] >= _RECORD.itemsize and head["record_stride"] % 8 == 0 and
            head["shape_stride"] >= _SHAPE_BYTES + 12 * self.vertices and head["shape_stride"] % 8 == 0 and
            _fits(size, head["setup_offset"], 1, _SETUP.itemsize) and
            _fits(size, head["triangles_offset"], self.triangle_count, 12) and
            _fits(size, head["rest_offset"], self.vertices, 12) and
            _fits(size, head["records_offset"], head["record_slots"], head["record_stride"]) and
            _fits(size, head["shapes_offset"], head["shape_slots"], head["shape_stride"]))
        if not is_usable:
            raise SegmentError(f"{self.path} is damaged: its header does not fit its size")

    def _read(self, offset, buffer):
        """Fills the buffer; False if the file is too short."""
        view = memoryview(buffer).cast("B") if buffer.nbytes else b""
        return len(view) == 0 or os.preadv(self._file, [view], offset) == len(view)

    def _word(self, offset, form="=Q"):
        raw = os.pread(self._file, struct.calcsize(form), offset)
        return struct.unpack(form, raw)[0] if len(raw) == struct.calcsize(form) else 0

    def life(self):
        """Whether the run RUNS, has ENDED, or was KILLED: while it lives, it holds a lock."""
        if self._word(_STATE_AT, "=I") == _ENDED:
            return ENDED
        asked = struct.pack(_FLOCK, fcntl.F_RDLCK, os.SEEK_SET, 0, 0, 0)
        lock = struct.unpack(_FLOCK, fcntl.fcntl(self._file, fcntl.F_GETLK, asked))
        return KILLED if lock[0] == fcntl.F_UNLCK else RUNS

    def newest(self):
        """The number of the newest record; 0: none yet."""
        return self._word(_NEWEST_AT)

    def heartbeat_ns(self):
        """When the newest record's tick woke, by CLOCK_MONOTONIC."""
        return self._word(_HEARTBEAT_AT, "=q")

    def oldest(self, newest):
        """The number of the oldest record that the writer will not overwrite in the next tick."""
        return max(1, newest - self._header["record_slots"] + 2)

    def setup(self):
        """A Setup, or None while the writer changes it."""
        raw = np.zeros((), _SETUP)
        at = self._header["setup_offset"]
        before = self._word(at)
        if not self._read(at, raw) or before == 0 or before % 2 or self._word(at) != before:
            return None
        if before != 2 * int(raw["generation"]) + 2:
            return None
        setup = Setup(raw)
        numbers = np.array([*setup.origin, *setup.offset, setup.unit, setup.rate_hz])
        if not np.isfinite(numbers).all() or setup.unit <= 0.0:
            raise SegmentError(f"{self.path} is damaged: its setup has impossible numbers")
        return setup

    def is_of(self, setup):
        """Whether this setup is still that of the segment."""
        return self._word(self._header["setup_offset"]) == 2 * setup.generation + 2

    def triangles(self, setup):
        """(t, 3) int32; None while the writer changes it."""
        corners = np.zeros((self.triangle_count, 3), np.uint32)
        if not self._read(self._header["triangles_offset"], corners) or not self.is_of(setup):
            return None
        if corners.size and int(corners.max()) >= self.vertices:
            raise SegmentError(f"{self.path} is damaged: a triangle has a vertex that does not exist")
        return corners.astype(np.int32)

    def radii_m(self, setup):
        """(2, 26): from each joint to the skin, 0 where it is not known; None while the writer changes it."""
        radii = np.zeros((2, JOINTS), np.float32)
        at, size = setup.radii_offset, self._header["segment_bytes"]
        if self.version < (1, 2) or at == 0 or at + radii.nbytes > size:
            return radii
        if not self._read(at, radii) or not self.is_of(setup):
            return None
        return np.clip(np.nan_to_num(radii, nan=0.0, posinf=0.0, neginf=0.0), 0.0, 0.1)

    def frame(self, number):
        """The Frame of this record."""
        head, record = self._header, self._record
        at = head["records_offset"] + number % head["record_slots"] * head["record_stride"]
        whole = 2 * number + 2
        if number == 0 or self._word(at) != whole or not self._read(at, record) or self._word(at) != whole:
            return None
        units_per_metre, hands = float(record["units_per_metre"]), record["hands"]
        joints = hands["joints"].copy()
        if int(record["number"]) != number or not (0.0 < units_per_metre < float("inf")) or not np.isfinite(joints).all():
            return None
        return Frame(number, int(record["generation"]), int(record["tick"]), int(record["woke_ns"]),
                     int(record["shape_changes"]), units_per_metre, [int(each) for each in hands["flags"]], joints)

    def shape(self, number, setup):
        """(n, 3) float32, the floats of the vertices at this record. The next call overwrites them."""
        head = self._header
        at = head["shapes_offset"] + number % head["shape_slots"] * head["shape_stride"]
        whole = 2 * number + 2
        if self._word(at) != whole or self._word(at + 8) != number or not self._read(at + _SHAPE_BYTES, self._floats):
            return None
        if self._word(at) != whole or not self.is_of(setup) or not np.isfinite(self._floats).all():
            return None
        return self._floats.reshape(-1, 3)


class ModuleSegment(Segment):
    """Records and shapes through the Python module `nendo`, for processors on which Python cannot order its loads. The module has only
    the newest ones. What does not change while the segment exists is read as above."""

    def __init__(self, path):
        import nendo
        super().__init__(path)
        self._error = nendo.Error
        try:
            self._run = nendo.attach(os.path.basename(path)[len(PREFIX):])
        except nendo.Error as error:
            self.close()
            raise SegmentError(str(error)) from None

    def oldest(self, newest):
        return newest

    def frame(self, number):
        setup = self.setup()
        try:
            taken = self._run.frame() if number and setup else None
        except self._error:
            return None
        if taken is None or taken.number < number:
            return None
        joints = np.zeros((2, JOINTS, 7), np.float32)
        flags = [int(p) * _PRESENT | int(s) * _SILENT for p, s in zip(taken.present, taken.silent)]
        for side in (0, 1):
            if taken.present[side]:
                joints[side] = taken.hands[side]
        return Frame(int(taken.number), setup.generation, 0, round(taken.time_s * 1e9), int(taken.number),
                     float(taken.units_per_metre), flags, joints)

    def shape(self, number, setup):
        try:
            points = self._run.vertices()
        except self._error:
            return None
        return ((points - setup.origin - setup.offset) / setup.unit).astype(np.float32)


def _open(path):
    try:
        return os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    except PermissionError:
        raise SegmentError(f"{path} belongs to another user; that user can publish with shm:NAME?group=GROUP") from None
    except OSError as error:
        if error.errno == errno.ENOENT:
            raise FileNotFoundError(path) from None
        raise SegmentError(f"{path}: {error.strerror}") from None


def open_segment(name, folder=FOLDER, machine=None):
    """Opens the segment of the run NAME. Raises FileNotFoundError if there is none, and SegmentError."""
    if not name or "/" in name or "\0" in name:
        raise SegmentError("use the NAME of `nendo run --to shm:NAME`")
    path = os.path.join(folder, PREFIX + name)
    if (machine or platform.machine()) in ("x86_64", "AMD64"):
        return Segment(path)
    try:
        return ModuleSegment(path)
    except ImportError:
        raise SegmentError("on this processor the add-on needs the Python module nendo: install python3-nendo") from None


def names_of_runs(folder=FOLDER):
    """The names of all segments that this user may read and whose runs live, sorted."""
    names = []
    try:
        entries = sorted(os.listdir(folder))
    except OSError:
        return names
    for entry in entries:
        if not entry.startswith(PREFIX):
            continue
        try:
            segment = Segment(os.path.join(folder, entry))
        except (SegmentError, OSError):
            continue
        if segment.life() == RUNS:
            names.append(entry[len(PREFIX):])
        segment.close()
    return names
