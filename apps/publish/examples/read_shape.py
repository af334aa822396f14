#!/usr/bin/env python3
"""Writes the newest shape of `nendo run --publish shm:NAME` to standard output, as OBJ: read_shape.py NAME [--at-end].
With --at-end it waits until the run has ended. Needs nothing but Python; FORMAT.md explains the numbers."""
import mmap
import struct
import sys
import time

LIVE, ENDED = 1, 2


def main():
    names = [argument for argument in sys.argv[1:] if not argument.startswith("--")] or ["run"]
    with open(f"/dev/shm/nendo-{names[0]}", "rb") as file:
        segment = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)

    def u64(at):
        return struct.unpack_from("=Q", segment, at)[0]

    def state():
        return struct.unpack_from("=I", segment, 128)[0]

    magic, order, major = struct.unpack_from("=8sIH", segment, 0)
    if magic != b"NENDOPUB" or order != 0x01020304 or major != 1:
        sys.exit("not a segment of version 1")
    vertices, triangles, _, slots = struct.unpack_from("=4I", segment, 28)
    setup, faces = struct.unpack_from("=2Q", segment, 48)
    shapes, stride = struct.unpack_from("=2Q", segment, 88)
    while state() == LIVE and ("--at-end" in sys.argv or u64(136) == 0):
        time.sleep(0.01)
    while True:
        generation, number = u64(setup + 8), u64(136)
        slot = shapes + number % slots * stride
        before = u64(slot)
        loop = segment[setup:setup + 128]
        corners = segment[faces:faces + 12 * triangles]
        floats = segment[slot + 64:slot + 64 + 12 * vertices]
        if before == u64(slot) == 2 * number + 2 and u64(setup) == 2 * generation + 2:
            break  # what was copied is one tick's, and its setup is the loop's
        if number == 0 and state() == ENDED:
            sys.exit("the run ended without a tick")
    *origin, unit = struct.unpack_from("=4d", loop, 16)
    floats = struct.unpack(f"={3 * vertices}f", floats)
    corners = struct.unpack(f"={3 * triangles}I", corners)
    for at in range(0, len(floats), 3):
        print("v", *(origin[axis] + unit * floats[at + axis] for axis in range(3)))
    for at in range(0, len(corners), 3):
        print("f", *(corner + 1 for corner in corners[at:at + 3]))


main()
