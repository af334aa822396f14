#!/usr/bin/env python3
"""Judges what the subscribers of tools/check-ros2 have received, by apps/publish/FORMAT.md and the specifications of ROS 2.
It knows nothing of Nendo's sources.
  judge.py record NAME FILE   writes each record of the segment and of those that replace it, until SIGTERM
  judge.py values RECORDS LINES LEAST   each message has the values of a record, and no record is without a message between
                              the first message and the last; prints the latency
  judge.py types LINES        Fast DDS has read the types and their hashes
  judge.py wire INTERFACE FILE   writes a line for each datagram of DDS that comes there from elsewhere, until SIGTERM
  judge.py again RECORDS LINES   after the second run began, messages came within a second"""
import fcntl
import hashlib
import json
import mmap
import os
import signal
import socket
import struct
import sys
import time

FINGERS = ["mcp_flexion", "mcp_abduction", "pip_flexion", "dip_flexion"]
ANGLES = ["thumb_roll", "thumb_abduction", "thumb_mcp_flexion", "thumb_ip_flexion"] + [
    f"{finger}_{angle}" for finger in ("index", "middle", "ring", "little") for angle in FINGERS] + [
    "palm_arch", "wrist_pitch", "wrist_yaw"]
JOINTS = ["palm", "wrist", "thumb_metacarpal", "thumb_proximal", "thumb_distal", "thumb_tip"] + [
    f"{finger}_{joint}" for finger in ("index", "middle", "ring", "little")
    for joint in ("metacarpal", "proximal", "intermediate", "distal", "tip")]
DEFINITIONS = {
    "builtin_interfaces/msg/Time": "int32 sec,uint32 nanosec",
    "std_msgs/msg/Header": "builtin_interfaces/msg/Time stamp,string frame_id",
    "geometry_msgs/msg/Vector3": "float64 x,float64 y,float64 z",
    "geometry_msgs/msg/Point": "float64 x,float64 y,float64 z",
    "geometry_msgs/msg/Quaternion": "float64 x,float64 y,float64 z,float64 w",
    "geometry_msgs/msg/Pose": "geometry_msgs/msg/Point position,geometry_msgs/msg/Quaternion orientation",
    "geometry_msgs/msg/Transform": "geometry_msgs/msg/Vector3 translation,geometry_msgs/msg/Quaternion rotation",
    "geometry_msgs/msg/TransformStamped":
        "std_msgs/msg/Header header,string child_frame_id,geometry_msgs/msg/Transform transform",
    "geometry_msgs/msg/PoseArray": "std_msgs/msg/Header header,geometry_msgs/msg/Pose[] poses",
    "sensor_msgs/msg/JointState":
        "std_msgs/msg/Header header,string[] name,float64[] position,float64[] velocity,float64[] effort",
    "tf2_msgs/msg/TFMessage": "geometry_msgs/msg/TransformStamped[] transforms",
    "diagnostic_msgs/msg/KeyValue": "string key,string value",
    "diagnostic_msgs/msg/DiagnosticStatus":
        "byte level,string name,string message,string hardware_id,diagnostic_msgs/msg/KeyValue[] values",
    "diagnostic_msgs/msg/DiagnosticArray": "std_msgs/msg/Header header,diagnostic_msgs/msg/DiagnosticStatus[] status",
}
TOPICS = {
    "rt/joint_states": "sensor_msgs/msg/JointState", "rt/tf": "tf2_msgs/msg/TFMessage",
    "rt/tf_static": "tf2_msgs/msg/TFMessage", "rt/nendo/left/joints": "geometry_msgs/msg/PoseArray",
    "rt/nendo/right/joints": "geometry_msgs/msg/PoseArray", "rt/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
}


def fail(text):
    sys.exit(f"judge.py: {text}")


# ---- the segment


def hand(memory, at):
    flags, = struct.unpack_from("=I", memory, at)
    if flags & 1 == 0:
        return None
    floats = struct.unpack_from("=182f", memory, at + 16)
    return [floats[7 * joint:7 * joint + 7] for joint in range(26)]


def state(memory, at):
    _, measured = struct.unpack_from("=2I", memory, at)
    angles = struct.unpack_from("=23d", memory, at + 24)
    return {ANGLES[k]: angles[k] for k in range(23) if measured >> k & 1}


def read(memory, number):
    """Returns the bytes of a record and of its states, or None if they are not there, or no longer."""
    slots, = struct.unpack_from("=I", memory, 36)
    stride, = struct.unpack_from("=I", memory, 44)
    first, step = struct.unpack_from("=2Q", memory, 72)
    states, = struct.unpack_from("=Q", memory, 120)
    record, own = first + number % slots * step, states + number % slots * stride
    content = memory[record:record + 1616], memory[own:own + 560]
    whole = struct.pack("=Q", 2 * number + 2)
    stages = [content[0][:8], content[1][:8], memory[record:record + 8], memory[own:own + 8]]
    return content if all(stage == whole for stage in stages) else None


def decode(run, offset, record, states):
    number, = struct.unpack_from("=Q", record, 8)
    woke, = struct.unpack_from("=q", record, 72)
    return {"run": run, "offset": offset, "number": number, "woke": woke, "joints": [hand(record, 128), hand(record, 872)],
            "angles": [state(states, 32), state(states, 32 + 264)]}


def has_ended(file, memory):
    if struct.unpack_from("=I", memory, 128)[0] == 2:
        return True
    lock = struct.pack("hhqqi4x", fcntl.F_RDLCK, os.SEEK_SET, 0, 0, 0)
    return struct.unpack("hhqqi4x", fcntl.fcntl(file, fcntl.F_GETLK, lock))[0] == fcntl.F_UNLCK


def record(name, path):
    kept, stop = [], []
    signal.signal(signal.SIGTERM, lambda *_: stop.append(True))
    run = 0
    while not stop:
        try:
            file = open(f"/dev/shm/nendo-{name}", "rb")
        except FileNotFoundError:
            time.sleep(0.01)
            continue
        with file, mmap.mmap(file.fileno(), 0, prot=mmap.PROT_READ) as memory:
            following, looks, ended = 1, 0, has_ended(file, memory) # the remains of a killed run
            time.sleep(0.002)
            while not stop and not ended:
                looks += 1
                ended = looks % 50 == 0 and has_ended(file, memory)
                newest, = struct.unpack_from("=Q", memory, 136)
                for number in range(following, newest + 1):
                    content = read(memory, number)
                    offset = time.clock_gettime_ns(time.CLOCK_REALTIME) - time.clock_gettime_ns(time.CLOCK_MONOTONIC)
                    if content is not None:
                        kept.append((run, offset, *content))
                following = newest + 1
                time.sleep(0.002)
        run += following > 1
    with open(path, "w", encoding="ascii") as out: # at the end, because a disk may be slow
        for one in kept:
            out.write(json.dumps(decode(*one)) + "\n")


# ---- the messages


def records_of(path):
    with open(path, encoding="ascii") as file:
        return [json.loads(line) for line in file if line.endswith("\n")]


def lines_of(path, kind):
    with open(path, encoding="ascii") as file:
        for line in file:
            if line[0] == kind and line.endswith("\n"):
                yield line[:-1]


class Matcher:
    """Finds the record of a message by its stamp, which is when the tick woke."""

    def __init__(self, records):
        self.records = records
        self.at = 0

    def of(self, stamp):
        """Returns None for a tick that the recorder has missed, because the machine was busy."""
        distance = lambda at: abs(self.records[at]["woke"] + self.records[at]["offset"] - stamp)
        while self.at + 1 < len(self.records) and distance(self.at + 1) <= distance(self.at):
            self.at += 1
        return self.records[self.at] if distance(self.at) < 3_000_000 else None


def ros(joint):
    x, y, z, qx, qy, qz, qw = joint
    return [-z, -x, y, -qz, -qx, qy, qw]


def times(a, b):
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return [aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz]


def joined(parent, child):
    turn = parent[3:]
    moved = times(times(turn, list(child[:3]) + [0.0]), [-turn[0], -turn[1], -turn[2], turn[3]])
    return [p + m for p, m in zip(parent[:3], moved)] + times(turn, child[3:])


def far(a, b):
    place = max(abs(p - q) for p, q in zip(a[:3], b[:3]))
    same = max(abs(p - q) for p, q in zip(a[3:], b[3:]))
    opposite = max(abs(p + q) for p, q in zip(a[3:], b[3:]))
    return max(place, min(same, opposite))


def judge_angles(record, words):
    expected = {f"{side}_{name}": value for side, angles, joints in zip(("left", "right"), record["angles"], record["joints"])
                if joints for name, value in angles.items()}
    got = {name: float(value) for name, value in (word.split("=") for word in words)}
    if got != expected:
        fail(f"joint states of record {record['number']} differ")


def judge_poses(record, words):
    side = 0 if words[0] == "rt/nendo/left/joints" else 1
    got = [float(word) for word in words[2:]]
    expected = [number for joint in record["joints"][side] for number in ros(joint)]
    if words[1] != "stage" or got != expected:
        fail(f"{words[0]} of record {record['number']} differ")


def judge_transforms(record, words):
    parents = {}
    for word in words[1:]:
        names, *numbers = word.split(",")
        parent, child = names.split(">")
        parents[child] = (parent, [float(number) for number in numbers])
    frames = {"stage": [0, 0, 0, 0, 0, 0, 1]}

    def place(name):
        if name not in frames:
            parent, own = parents[name]
            frames[name] = joined(place(parent), own)
        return frames[name]

    for side, joints in zip(("left", "right"), record["joints"]):
        for name, joint in zip(JOINTS, joints):
            if far(place(f"{side}_{name}"), ros(joint)) > 1e-5:
                fail(f"frame {side}_{name} of record {record['number']} differs")


def judge_series(records, lines, least, kind, topic, judge):
    matcher, latencies, firsts, compared = Matcher(records), [], set(), 0
    for line in lines_of(lines, kind):
        _, received, stamp, *words = line.split(" ")
        if topic is not None and words[0] != topic:
            continue
        found = matcher.of(int(stamp))
        if found is not None:
            judge(found, words)
            firsts.add(found["number"] - len(latencies))
            compared += 1
        latencies.append((int(received) - int(stamp)) / 1e6)
    what = f"{lines}: {len(latencies)} messages of {topic or 'rt/joint_states'}"
    if len(latencies) < least or compared < 0.8 * len(latencies):
        fail(f"{what}, {compared} of them of recorded ticks; wanted: {least}, and 80 %")
    if len(firsts) != 1:
        fail(f"{what}: some are lost, or come twice")
    latencies.sort()
    print(f"{what}, 0 lost; {compared} compared, and equal; from the tick to the reader "
          f"p50 {latencies[len(latencies) // 2]:.2f} ms, p99 {latencies[len(latencies) * 99 // 100]:.2f} ms")


def values(path, lines, least):
    records = records_of(path)
    for kind, topic, judge in (("J", None, judge_angles), ("P", "rt/nendo/left/joints", judge_poses),
                               ("P", "rt/nendo/right/joints", judge_poses), ("T", "rt/tf", judge_transforms)):
        judge_series(records, lines, least, kind, topic, judge)
    if not any(" rt/tf_static stage>stage_y_up,0,0,0,0.5,-0.5,-0.5,0.5" in line for line in lines_of(lines, "T")):
        fail(f"{lines}: the static transform did not come")
    statuses = list(lines_of(lines, "D"))
    if not any("\t0|nendo-ros2: right glove|" in line for line in statuses):
        fail(f"{lines}: no status of the right glove")
    print(f"{lines}: the static transform, and {len(statuses)} messages of rt/diagnostics")


def hash_of(name):
    ids = {"int32": 6, "uint32": 7, "float64": 11, "byte": 16, "string": 17}

    def fields(one):
        for field in DEFINITIONS[one].split(","):
            kind, label = field.split(" ")
            yield kind.removesuffix("[]"), kind.endswith("[]"), label

    def description(one):
        return {"type_name": one, "fields": [
            {"name": label, "type": {"type_id": ids.get(kind, 1) + 144 * many, "capacity": 0, "string_capacity": 0,
                                     "nested_type_name": "" if kind in ids else kind}}
            for kind, many, label in fields(one)]}

    def collect(one, found):
        for kind, _, _ in fields(one):
            if kind not in ids and kind not in found:
                found.add(kind)
                collect(kind, found)
        return found

    text = json.dumps({"type_description": description(name),
                       "referenced_type_descriptions": [description(one) for one in sorted(collect(name, set()))]})
    return "RIHS01_" + hashlib.sha256(text.encode()).hexdigest()


def types(lines):
    found = {}
    for line in lines_of(lines, "U"):
        _, topic, kind, data = line.split(" ")
        found[topic] = (kind, data)
    for topic, name in TOPICS.items():
        package, _, short = name.split("/")
        expected = (f"{package}::msg::dds_::{short}_", f"typehash={hash_of(name)};")
        if found.get(topic) != expected:
            fail(f"{topic}: {found.get(topic)} is not {expected}")
    print(f"{lines}: {len(TOPICS)} topics with the types and hashes of ROS 2")


def wire(interface, path):
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    packets = socket.socket(socket.AF_PACKET, socket.SOCK_DGRAM, socket.htons(0x0800))
    packets.bind((interface, 0))
    with open(path, "w", encoding="ascii") as out:
        while True:
            packet, address = packets.recvfrom(65536)
            own = address[2] == socket.PACKET_OUTGOING
            head = 4 * (packet[0] & 15)
            if packet[9] == socket.IPPROTO_UDP and not own and packet[head + 8:head + 12] == b"RTPS":
                out.write(f"{socket.inet_ntoa(packet[12:16])} to {socket.inet_ntoa(packet[16:20])}\n")
                out.flush()


def again(path, lines):
    records = [one for one in records_of(path) if one["run"] == 1]
    if not records:
        fail("there is no second run")
    begin = records[0]["woke"] + records[0]["offset"]
    after = [int(line.split(" ")[1]) for line in lines_of(lines, "J") if int(line.split(" ")[2]) > begin - 3_000_000]
    if not after or after[0] - begin > 1_000_000_000:
        fail("after the run was started again, no message came within a second")
    print(f"{lines}: {(after[0] - begin) / 1e6:.0f} ms after the first tick of the next run, its first message")


if __name__ == "__main__":
    what, *arguments = sys.argv[1:] or [""]
    if what == "values":
        values(arguments[0], arguments[1], int(arguments[2]))
    elif what in ("record", "types", "wire", "again"):
        {"record": record, "types": types, "wire": wire, "again": again}[what](*arguments)
    else:
        sys.exit(__doc__)
