#!/usr/bin/env python3
"""A client of `nendo serve` for tests of the server, independent of it: written from apps/serve/PROTOCOL.md alone, standard
library only. usage: serve_client.py SOCKET N. Reads N samples of each glove and as many poses, then ten frames of hands, checks
each line, and prints how many there were of each class. In each sample all counts are the sequence number; pose k is at
(k / 3, 0.1, -1e-300) m."""
import json
import math
import socket
import sys
import time

JOINTS = "palm wrist".split() + [f"thumb_{part}" for part in "metacarpal proximal distal tip".split()] + [
    f"{finger}_{part}" for finger in "index middle ring little".split() for part in
    "metacarpal proximal intermediate distal tip".split()]
KINDS = {"device", "simulated", "recorded"}


class Session:
    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.settimeout(20)
        self.socket.connect(path)
        self.lines = self.socket.makefile(encoding="utf-8", newline="\n")

    def next(self):
        line = self.lines.readline()
        assert line.endswith("\n"), line
        return json.loads(line)

    def ask(self, **choices):
        self.socket.sendall(json.dumps({"class": "WATCH", **choices}).encode() + b"\n")


def check_introduction(session):
    version = session.next()
    assert version["class"] == "VERSION" and version["protocol"] == 1 and version["name"] == "hands", version
    assert isinstance(version["version"], str)
    session.ask(samples=False)
    gloves, trackers = [], []
    for line in iter(session.next, None):
        if line["class"] == "WATCH":
            break
        (gloves if line["class"] == "GLOVE" else trackers).append(line)
    for index, glove in enumerate(gloves):
        assert glove["index"] == index and glove["side"] in ("left", "right") and glove["hand"] in ("left", "right")
        assert isinstance(glove["source"], str) and isinstance(glove["model"], str) and glove["kind"] in KINDS
        assert len(glove["sensors"]) == 22 and len(glove["angles"]) == 23 and glove["rate_hz"] == 90
        assert isinstance(glove["counts"]["most"], int) and isinstance(glove["counts"]["whole_range"], bool)
        assert set(glove["abilities"]) == {"wrist_switch", "light", "vibration", "resistance"}
        assert glove["facts"]["serial"] == "A" + glove["side"] and "at_end" not in glove
    for index, tracker in enumerate(trackers):
        assert tracker["class"] == "TRACKER" and tracker["index"] == index and tracker["station"] in tracker["stations"]
        assert tracker["rate_hz"] == 120 and tracker["filtered"] is False and tracker["kind"] in KINDS
        assert math.isclose(sum(part * part for part in tracker["stage_from_tracker_xyzw"]), 1)
    print(f"VERSION 1\nGLOVE {len(gloves)}\nTRACKER {len(trackers)}")
    return gloves, trackers


def check_sample(line, glove):
    number = line["sequence"]
    assert list(line["raw"]) == glove["sensors"] and set(line["raw"].values()) == {number % 65536}, line
    assert line["hand"] == glove["hand"] and line["switch"] is None and line["sampled_too_fast"] is False
    assert "device_time_ns" not in line and "recorded_arrival_ns" not in line


def check_pose(line, tracker):
    assert line["station"] == tracker["station"] and line["error"] is None
    assert line["position_m"] == [line["sequence"] / 3, 0.1, -1e-300], line
    assert line["turn_xyzw"] == [0.5, -0.5, 0.5, 0.5]


def check_samples(session, gloves, trackers, count):
    session.ask(samples=True)
    assert session.next() == {"class": "WATCH", "samples": True, "hands": False, "rate_hz": 30}
    last = {}
    counted = {"SAMPLE": 0, "POSE": 0}
    while any(counted[kind] < count * len(some) for kind, some in (("SAMPLE", gloves), ("POSE", trackers))):
        line = session.next()
        kind = line["class"]
        index = line["glove" if kind == "SAMPLE" else "tracker"]
        key = (kind, index)
        if counted[kind] == count * len(gloves if kind == "SAMPLE" else trackers):
            continue
        counted[kind] += 1
        now_ns = time.clock_gettime_ns(time.CLOCK_MONOTONIC)
        assert isinstance(line["arrival_ns"], int) and 0 <= now_ns - line["arrival_ns"] < 10e9
        assert 0 <= line["arrival_ns"] - line["measured_ns"] < 10e6
        if key in last:
            assert line["sequence"] == last[key] + 1 + line["dropped"], line
        last[key] = line["sequence"]
        check_sample(line, gloves[index]) if kind == "SAMPLE" else check_pose(line, trackers[index])
    print(f"SAMPLE {counted['SAMPLE']}\nPOSE {counted['POSE']}")


def check_hands(session):
    session.ask(samples=False, hands=True, rate_hz=100)
    ticks = []
    while len(ticks) < 10:
        line = session.next()
        if line["class"] != "HANDS":
            continue
        assert not ticks or line["tick"] > ticks[-1]
        ticks.append(line["tick"])
        assert [hand["side"] for hand in line["hands"]] == ["left", "right"] and line["skipped"] == 0
        for hand in line["hands"]:
            assert list(hand["joints"]) == JOINTS
            for joint in hand["joints"].values():
                assert len(joint["position_m"]) == 3 and joint["orientation_xyzw"][3] >= 0
                assert math.isclose(sum(part * part for part in joint["orientation_xyzw"]), 1)
            assert len(hand["angles_rad"]) == 23 and set(hand["measured"]) <= set(hand["angles_rad"])
            assert list(hand["pinch_m"]) == ["index", "middle", "ring", "little"]
            assert hand["silent"] is False and hand["tracked"] is False and hand["lost"] is False
            assert hand["switch"] is None and hand["tracked_ns"] is None and isinstance(hand["sampled_ns"], int)
    print(f"HANDS {len(ticks)}")


def check_error(session):
    session.socket.sendall(b"what is this?\n")
    for line in iter(session.next, None):
        if line["class"] == "ERROR":
            break
    assert line["message"]
    try:
        assert session.lines.readline() == ""
    except ConnectionResetError:
        pass
    print("closed after an error")


def main():
    session = Session(sys.argv[1])
    gloves, trackers = check_introduction(session)
    check_samples(session, gloves, trackers, int(sys.argv[2]))
    check_hands(session)
    check_error(session)


main()
