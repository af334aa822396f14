"""Gloves shape a model for two seconds.
   live_loop.py MODEL OUT [LEFT [RIGHT]]    gloves as in `nendo run`; without any: those of this machine, or simulated hands"""
import sys
import time

import nendo

end = time.monotonic() + 2
with nendo.Session(sys.argv[1], left=(sys.argv[3:] or [""])[0], right=(sys.argv[4:] or [""])[0]) as session:
    for note in session.notes:
        print(note)
    for frame in session:
        if frame.number % 45 == 0:
            print(f"tick {frame.number}: index fingertips at {frame.hands[:, 10, :3].round(3).tolist()} m")
        if time.monotonic() > end:
            break
    shape = session.finish()

shape.write(sys.argv[2])
print(f"{session.stats['ticks']} ticks, the shape: {sys.argv[2]}")
