"""Prints what a recording contains, from its arrays.
   recording_arrays.py TAKE.nendo"""
import sys

import numpy as np

import nendo

take = nendo.Recording(sys.argv[1])
for number, glove in enumerate(take.gloves):
    angles = take.calibration(number).joint_angles(take.samples(number))  # (n, 23)
    bent = np.degrees(angles[:, nendo.ANGLE_NAMES.index("index_pip_flexion")])
    print(f"{glove}: {len(angles)} samples, index PIP from {bent.min():.0f} to {bent.max():.0f} degrees")

hands = take.hands()  # (ticks, 2, 26, 7)
paths = np.linalg.norm(np.diff(hands[:, :, 10, :3], axis=0), axis=-1).sum(axis=0)
print(f"{len(hands)} ticks; the index fingertips moved by {paths.round(2).tolist()} m")
