#!/usr/bin/env python3
"""Prints the counts that a glove would send on a hand that a camera has seen.

usage: optical_counts.py MOTION.csv CALIBRATION.csv

MOTION is a table of joints' places (tests/hand/motions), CALIBRATION what `nendo calibration export --format csv`
writes. The table that comes out is a glove: `nendo record replay:COUNTS.csv`. With --angles it holds the angles
instead, in degrees, by the names of Nendo's joints.
"""

import csv
import math
import sys

FINGERS = ["index", "middle", "ring", "little"]


def sub(a, b):
    return [p - q for p, q in zip(a, b)]


def dot(a, b):
    return sum(p * q for p, q in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    length = math.sqrt(dot(a, a))
    return [p / length for p in a]


def bend(before, after, axis):
    """The angle from one bone to the next, positive about the axis."""
    turn = cross(before, after)
    return math.atan2(math.copysign(math.sqrt(dot(turn, turn)), dot(turn, axis)), dot(before, after))


def angles_of(row):
    """Of a frame, in radians. A flat palm's own axes are the reference; bones are joined by hinges."""
    place = lambda joint: [float(row[f"{joint}_{axis}_mm"]) for axis in "xyz"]
    palm = lambda what: unit([float(row[f"palm_{what}_{axis}"]) for axis in "xyz"])
    ahead, out = palm("dir"), palm("normal")
    hinge = unit(cross(ahead, out))  # turning about it flexes
    to_thumb = hinge if row["hand"] == "right" else [-p for p in hinge]
    bones = {}
    for finger in ["thumb"] + FINGERS:
        seen = "pinky" if finger == "little" else finger  # the camera's name
        joints = [place(f"{seen}_{joint}") for joint in ("mcp", "pip", "dip", "tip")]
        bones[finger] = [unit(sub(b, a)) for a, b in zip(joints, joints[1:])]
    angles, spread = {}, {}
    for finger, (first, middle, last) in bones.items():
        if finger == "thumb":  # what the camera calls its mcp is the saddle joint
            angles["thumb_roll"] = math.atan2(dot(first, out), dot(first, to_thumb))
            angles["thumb_abduction"] = math.acos(max(-1.0, min(1.0, dot(first, ahead))))
            angles["thumb_mcp"] = math.acos(max(-1.0, min(1.0, dot(first, middle))))
            angles["thumb_ip"] = math.acos(max(-1.0, min(1.0, dot(middle, last))))
            continue
        angles[f"{finger}_mcp"] = math.atan2(dot(first, out), dot(first, ahead))
        angles[f"{finger}_pip"] = bend(first, middle, hinge)
        angles[f"{finger}_dip"] = bend(middle, last, hinge)
        spread[finger] = math.asin(max(-1.0, min(1.0, dot(first, to_thumb))))
    for one, other in zip(FINGERS, FINGERS[1:]):
        angles[f"{one}_{other}_abduction"] = spread[one] - spread[other]
    return angles


def main():
    wants_angles = "--angles" in sys.argv
    files = [word for word in sys.argv[1:] if word != "--angles"]
    if len(files) != 2:
        sys.exit(__doc__)
    lines = {}
    with open(files[1], encoding="utf-8") as file:
        for row in csv.DictReader(line for line in file if not line.startswith("#")):
            lines[row["sensor"]] = float(row["gain_rad_per_count"]), float(row["offset_counts"])
    with open(files[0], encoding="utf-8") as file:
        rows = [(float(row["t_s"]), row["hand"], angles_of(row)) for row in csv.DictReader(file)]
    sensors = [sensor for sensor in rows[0][2] if sensor in lines]
    ending = "_deg" if wants_angles else "_count"
    print(",".join(["time_s", "hand"] + [sensor + ending for sensor in sensors]))
    for time_s, hand, angles in rows:
        cells = []
        for sensor in sensors:
            gain, offset = lines[sensor]
            count = min(255, max(0, round(offset + angles[sensor] / gain)))
            cells.append(f"{math.degrees(angles[sensor]):.3f}" if wants_angles else str(count))
        print(",".join([f"{time_s:.6f}", hand] + cells))


if __name__ == "__main__":
    main()
