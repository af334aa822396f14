#!/usr/bin/env python3
"""Writes the newest shape of `nendo run --to shm:NAME` to standard output, as OBJ: read_shape.py NAME [--at-end].
With --at-end it waits until the run has ended. Needs nothing but Python; FORMAT.md explains the numbers."""
import fcntl
import mmap
import os
import struct
import sys
import time

ENDED = 2


def main():
    names = [argument for argument in sys.argv[1:] if not argument.startswith("--")] or ["run"]
    file = os.open(f"/dev/shm/nendo-{names[0]}", os.O_RDONLY)
    segment = mmap.mmap(file, 0, access=mmap.ACCESS_READ)

    def u64(at):
        return struct.unpack_from("=Q", segment, at)[0]

    def is_over():  # ended, or killed: while the run lives it holds a lock on the file
        lock = fcntl.fcntl(file, fcntl.F_GETLK, struct.pack("hhqqi4x", fcntl.F_RDLCK, os.SEEK_SET, 0, 0, 0))
        return struct.unpack_from("=I", segment, 128)[0] == ENDED or struct.unpack_from("h", lock)[0] == fcntl.F_UNLCK

    magic, order, major = struct.unpack_from("=8sIH", segment, 0)
    if magic != b"NENDOPUB" or order != 0x01020304 or major != 1:
        sys.exit("not a segment of version 1")
    vertices, triangles, record_slots, shape_slots = struct.unpack_from("=4I", segment, 28)
    setup, faces = struct.unpack_from("=2Q", segment, 48)
    records, record_stride, shapes, shape_stride = struct.unpack_from("=4Q", segment, 72)
    while not is_over() and ("--at-end" in sys.argv or u64(136) == 0):
        time.sleep(0.01)
    while True:
        over, number = is_over(), u64(136)
        record, slot = records + number % record_slots * record_stride, shapes + number % shape_slots * shape_stride
        before = u64(record), u64(slot), u64(setup)
        wanted = 2 * number + 2, 2 * number + 2, 2 * u64(record + 16) + 2  # that record's generation
        loop = segment[setup:setup + 128]
        corners = segment[faces:faces + 12 * triangles]
        floats = segment[slot + 64:slot + 64 + 12 * vertices]
        if before == wanted == (u64(record), u64(slot), u64(setup)):
            break  # what was copied is one tick's, and its setup is that tick's loop's
        if over:
            sys.exit("the run ended without a whole shape")
    *origin, unit = struct.unpack_from("=4d", loop, 16)
    floats = struct.unpack(f"={3 * vertices}f", floats)
    corners = struct.unpack(f"={3 * triangles}I", corners)
    for at in range(0, len(floats), 3):
        print("v", *(origin[axis] + unit * floats[at + axis] for axis in range(3)))
    for at in range(0, len(corners), 3):
        print("f", *(corner + 1 for corner in corners[at:at + 3]))


main()
