"""Data gloves that shape 3-D models: read gloves and trackers, pose hands, deform meshes, replay recordings, run the loop.

Lengths are in metres and times in seconds by time.monotonic(), unless a name or a docstring says otherwise; meshes have the
units of their file. Arrays that functions take are NumPy arrays in C order, float64, and int32 or uint32 for indices; others
raise TypeError or ValueError. Arrays that functions return are copies.
"""
from ._nendo import (ANGLE_LIMITS_RAD, ANGLE_NAMES, JOINT_NAMES, JOINT_PARENTS, POSE_NAMES, SENSOR_NAMES, AccessError,
                     Calibration, Clay, Error, Field, FoundDevice, Frame, Glove, GloveInfo, Hand, HandSkeleton, Mesh,
                     NotFoundError, Recording, Replay, Segment, Session, Tracker, Type1Deformer, Type2Deformer, __version__,
                     attach, deform, devices, join, open, open_tracker, pose_dtype, sample_dtype, tick_dtype)

__all__ = ["ANGLE_LIMITS_RAD", "ANGLE_NAMES", "JOINT_NAMES", "JOINT_PARENTS", "POSE_NAMES", "SENSOR_NAMES", "AccessError",
           "Calibration", "Clay", "Error", "Field", "FoundDevice", "Frame", "Glove", "GloveInfo", "Hand", "HandSkeleton", "Mesh",
           "NotFoundError", "Recording", "Replay", "Segment", "Session", "Tracker", "Type1Deformer", "Type2Deformer",
           "__version__", "attach", "deform", "devices", "join", "open", "open_tracker", "pose_dtype", "sample_dtype",
           "tick_dtype"]
