"""Prints where the fingertips are for a second, in metres from the wrist.
   hand_pose.py [GLOVE]    as in `nendo run`: sim:grasp (the default), auto, serial:/dev/ttyUSB0"""
import sys

import nendo

TIPS = [(name, at) for at, name in enumerate(nendo.JOINT_NAMES) if name.endswith("_tip")]

with nendo.open(sys.argv[1] if len(sys.argv) > 1 else "sim:grasp") as glove:
    for number, hand in enumerate(glove):
        if number % 10 == 0:
            places = hand.joints[:, :3, 3]
            print("  ".join(f"{name} {places[at].round(3)}" for name, at in TIPS))
        if number == 90:
            break
