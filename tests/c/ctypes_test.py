#!/usr/bin/env python3
"""ctypes_test.py LIBRARY: calls the C interface from another language, by what nendo.h says."""
import ctypes
import math
import sys
import time
from ctypes import POINTER, byref, c_char_p, c_double, c_float, c_int, c_size_t, c_uint32, c_uint64, c_void_p


class Joint(ctypes.Structure):
    _fields_ = [("position", c_float * 3), ("orientation", c_float * 4)]


class Hand(ctypes.Structure):
    _fields_ = [("flags", c_uint32), ("side", c_uint32), ("samples", c_uint64), ("time_s", c_double),
                ("angles", c_double * 23), ("joints", Joint * 26)]


nendo = ctypes.CDLL(sys.argv[1])
nendo.nendo_message.restype = nendo.nendo_version.restype = c_char_p
nendo.nendo_glove_model.restype = c_char_p
nendo.nendo_glove_open.argtypes = [c_char_p, c_char_p, POINTER(c_void_p)]
nendo.nendo_glove_hand.argtypes = [c_void_p, POINTER(Hand)]
nendo.nendo_glove_close.argtypes = nendo.nendo_glove_model.argtypes = [c_void_p]
nendo.nendo_deformer_make.argtypes = [POINTER(c_double), c_size_t, c_size_t, c_double, c_char_p, POINTER(c_void_p)]
nendo.nendo_deformer_grab.argtypes = [c_void_p, POINTER(c_double)]
nendo.nendo_deformer_move.argtypes = [c_void_p, POINTER(c_double), POINTER(c_double)]
nendo.nendo_deformer_free.argtypes = [c_void_p]

assert nendo.nendo_version()[0:1].isdigit()
glove = c_void_p()
assert nendo.nendo_glove_open(b"sim:grasp?hand=left", None, byref(glove)) == 0, nendo.nendo_message()
assert nendo.nendo_glove_model(glove)
seen = []
for _ in range(40):
    hand = Hand()
    assert nendo.nendo_glove_hand(glove, byref(hand)) == 0
    seen.append(hand)
    time.sleep(0.02)
nendo.nendo_glove_close(glove)
assert seen[-1].samples > seen[0].samples > 0
for hand in seen:
    assert hand.flags & 1 and hand.side == 0 and abs(hand.time_s - time.monotonic()) < 60
    for joint in hand.joints:
        assert all(map(math.isfinite, joint.position)) and abs(math.hypot(*joint.orientation) - 1) < 1e-5
spread = [max(hand.joints[10].position[axis] for hand in seen) - min(hand.joints[10].position[axis] for hand in seen) for axis in range(3)]
assert max(spread) > 0.005, spread  # metres: the finger bends
assert nendo.nendo_glove_open(b"no such glove", None, byref(glove)) == 2 and b"no such glove" in nendo.nendo_message()

# One control point at the origin moves by 1 along x: a vertex there follows, one beyond the radius stays.
vertices = (c_double * 9)(0, 0, 0, 0, 0.5, 0, 0, 5, 0)
moved = (c_double * 9)()
deformer = c_void_p()
assert nendo.nendo_deformer_make(vertices, 3, 1, 1.0, None, byref(deformer)) == 0, nendo.nendo_message()
assert nendo.nendo_deformer_grab(deformer, (c_double * 3)(0, 0, 0)) == 0
assert nendo.nendo_deformer_move(deformer, (c_double * 3)(1, 0, 0), moved) == 0
nendo.nendo_deformer_free(deformer)
wendland_c2 = (1 - 0.5) ** 4 * (4 * 0.5 + 1)
assert abs(moved[0] - 1) < 1e-5 and abs(moved[3] - wendland_c2) < 1e-5 and list(moved[6:]) == [0, 5, 0], list(moved)
