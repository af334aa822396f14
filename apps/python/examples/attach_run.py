"""Follows the hands of a run of another program for a second, as `nendo run --to shm:NAME` shows them.
   attach_run.py NAME"""
import sys

import nendo

run = nendo.attach(sys.argv[1])
print(f"a model of {len(run.faces)} triangles")
for number, frame in enumerate(run):
    if number % 30 == 0:
        for side, present, hand in zip(("left", "right"), frame.present, frame.hands):
            if present:
                print(f"{frame.time_s:.3f} s: {side} index fingertip at {hand[10, :3].round(3)} m")
    if number == 90:
        break
