"""Reads a glove for a second, and prints the mean count of each sensor.
   read_glove.py [GLOVE]    as in `nendo run`: sim (the default), auto, serial:/dev/ttyUSB0"""
import sys
import time

import nendo

with nendo.open(sys.argv[1] if len(sys.argv) > 1 else "sim") as glove:
    print(glove.info)
    time.sleep(1)  # meanwhile, the samples wait
    samples = glove.read()

print(f"{len(samples)} samples, of which {glove.stats['dropped']} were dropped")
means = samples["counts"].mean(axis=0)
for name, mean, present in zip(nendo.SENSOR_NAMES, means, samples["present"][-1]):
    if present:
        print(f"{name:24} {mean:6.1f}")
