#!/usr/bin/env python3
"""Follows a segment as apps/publish/FORMAT.md describes it, and knows nothing of Nendo's sources: their test.
read_segment.py NAME: a JSON object for each record that it sees, one with the last shape when the run has ended.
Ends with 1 at the first thing that does not fit."""
import json
import mmap
import os
import struct
import sys
import time

segment = None


def take(form, at):
    values = struct.unpack_from("=" + form, segment, at)
    return values[0] if len(values) == 1 else list(values)


def hand(at):
    flags, _, samples = take("IIQ", at)
    joints = [take("7f", at + 16 + 28 * joint) for joint in range(26)]
    lengths = [sum(part * part for part in joint[3:]) for joint in joints]
    return {"present": flags & 1, "silent": flags >> 1 & 1, "samples": samples, "index_tip": joints[10][:3],
            "turns": all(abs(length - 1) < 1e-5 for length in lengths)}


def state(at):
    flags, measured, sampled, tracked = take("2I2q", at)
    angles, forearm, touch = take("23d", at + 24), take("7f", at + 208), take("6f", at + 236)
    return {"switch": flags & 3, "tracked": flags >> 2 & 3, "measured": measured, "sampled": sampled, "pose": tracked,
            "angles": angles, "forearm": forearm, "touch": touch}


def states(at, number):
    both = [state(at + 32), state(at + 32 + 264)]
    return both if take("2Q", at) == [2 * number + 2, number] else None


def record(at, number, generation):
    names = ("number", "generation", "tick", "ticks", "missed", "rest_changes", "shape_jumps", "scheduled", "woke", "since_last",
             "shape_changes")
    if take("Q", at) != 2 * number + 2:
        return None
    entry = dict(zip(names, take("7Q3qQ", at + 8)))
    entry.update(zip(("units_per_metre", "flags", "status", "mode", "fields", "fields_bytes"), take("d4IQ", at + 96)))
    entry["hands"] = [hand(at + 128), hand(at + 128 + 744)]
    begin = end = at + 1616
    functions = 0
    for _ in range(entry["fields"] if entry["fields_bytes"] < 1 << 24 else 0):
        count = take("I", end + 4)
        functions += count
        end += 104 + 56 * count
        if count > 1000:
            break
    if take("Q", at) != 2 * number + 2:
        return None
    assert entry["number"] == number and end - begin == entry["fields_bytes"], "record"
    assert entry["generation"] == generation, "generation"
    assert all(side["turns"] for side in entry["hands"] if side["present"]), "orientations"
    entry["functions"] = functions
    return entry


def main():
    global segment
    path = f"/dev/shm/nendo-{sys.argv[1]}"
    with open(path, "rb") as file:
        status = os.fstat(file.fileno())
        segment = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
    assert status.st_mode & 0o7777 == 0o400, "mode"
    assert take("8s", 0) == b"NENDOPUB" and take("I2HQ", 8) == [0x01020304, 1, 2, len(segment)], "header"
    pid, vertices, triangles, slots, shape_slots = take("5I", 24)
    setup, faces, rest, records, stride, shapes, shape_stride, created, _ = take("7Q2q", 48)
    states_stride, states_at = take("I", 44), take("Q", 120)
    radii = take("52f", take("I", setup + 68))
    assert all(0.004 < radius < 0.03 for radius in radii), "radii"
    assert created <= time.clock_gettime_ns(time.CLOCK_MONOTONIC), "created"
    generation = take("Q", setup + 8)
    assert take("Q", setup) == 2 * generation + 2, "setup"
    assert max(take(f"{3 * triangles}I", faces)) < vertices, "triangles"
    origin, unit = take("3d", setup + 16), take("d", setup + 40)
    following, seen, ended = 1, 0, False
    while not ended:
        ended = take("I", 128) == 2
        newest = take("Q", 136)
        for number in range(max(following, newest - slots + 2), newest + 1):
            entry = record(records + number % slots * stride, number, generation)
            report = states(states_at + number % slots * states_stride, number)
            if entry and report:
                entry["states"] = report
                assert all(side["sampled"] <= entry["woke"] + 5_000_000 for side in report), "times of samples"
                seen += 1
                print(json.dumps(entry))
        following = newest + 1
        if not ended and newest and time.clock_gettime_ns(time.CLOCK_MONOTONIC) - take("q", 144) > 60e9:
            sys.exit("no heartbeat for a minute")
        time.sleep(0.002)
    slot = shapes + newest % shape_slots * shape_stride
    assert take("2Q", slot) == [2 * newest + 2, newest], "shape"
    shape = [origin[k % 3] + unit * c for k, c in enumerate(take(f"{3 * vertices}f", slot + 64))]
    still = [origin[k % 3] + unit * c for k, c in enumerate(take(f"{3 * vertices}f", rest))]
    print(json.dumps({"pid": pid, "newest": newest, "seen": seen, "shape": shape, "rest": still}))


main()
