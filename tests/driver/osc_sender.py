#!/usr/bin/env python3
"""Sends poses by OSC 1.0 over UDP, and knows nothing of Nendo's sources: the test of its inlet.
osc_sender.py PORT MODE COUNT    MODE: whole, bundled, tagged, phone, phone-bundle, hostile
Pose k of COUNT has the position (k/1000, 0.25, -0.5) and is turned by k/100 rad about y. Sends one per 4 ms; a phone, one per
16 ms. `hostile` sends what is no pose, or no OSC, before each pose."""
import math
import random
import socket
import struct
import sys
import time

NTP_OF_1970 = 2208988800
SENDER = "/0A1B-2C3D"  # a phone's own name


def text(value):
    data = value.encode("ascii") + b"\0"
    return data + b"\0" * (-len(data) % 4)


def message(address, types, *values):
    codes = {"f": ">f", "d": ">d", "i": ">i"}
    body = b"".join(text(value) if kind == "s" else struct.pack(codes[kind], value) for kind, value in zip(types, values))
    return text(address) + text("," + types) + body


def bundle(seconds, *elements):
    """With the time tag of `seconds` since 1970, or "immediately"."""
    if seconds is None:
        tag = struct.pack(">Q", 1)
    else:
        whole = math.floor(seconds)
        tag = struct.pack(">II", (whole + NTP_OF_1970) % 2**32, int((seconds - whole) * 2**32))
    return text("#bundle") + tag + b"".join(struct.pack(">i", len(element)) + element for element in elements)


def pose(k):
    return (k / 1000, 0.25, -0.5), (0.0, math.sin(k / 200), 0.0, math.cos(k / 200))


def whole(side, k, kind="f"):
    position, turn = pose(k)
    return message("/nendo/wrist/" + side, kind * 7, *position, *turn)


def phone(k):
    position, turn = pose(k)
    return message(SENDER + "/arkitposition", "fff", *position), message(SENDER + "/arkitrotation", "ffff", *turn)


def hostile(k, chance):
    """What a careless or malicious program might send."""
    good = whole("left", 5000 + k)  # its position would be seen
    cut = good[:chance.randrange(1, len(good))]
    deep = good
    for _ in range(40):
        deep = bundle(None, deep)
    changed = bytearray(bundle(None, good))
    changed[16:20] = struct.pack(">i", chance.choice((-4, 3, 1 << 30, len(good) + 4)))
    position, turn = pose(k)
    return [
        chance.randbytes(chance.randrange(1, 1400)), cut, deep, bytes(changed), bundle(None)[:12], b"\0" * 32,
        bundle(None, *[good] * 30),  # longer than one frame of Ethernet
        message("/nendo/wrist/left", "fffffff", math.nan, *position[1:], *turn),
        message("/nendo/wrist/left", "fffffff", math.inf, *position[1:], *turn),
        message("/nendo/wrist/left", "ddddddd", 1e300, *position[1:], *turn),
        message("/nendo/wrist/left", "fffffff", *position, 0.0, 0.0, 0.0, 0.0),
        message("/nendo/wrist/left", "ffffff", *position, *turn[:3]),
        message("/nendo/wrist/left", "ffffffff", *position, *turn, 1.0),
        message("/nendo/wrist/left", "sffffff", "x", *position[1:], *turn),
        message("/nendo/wrist/left", "fffffff", *position, *turn)[:-4],
        message("/nendo/wrist/*", "fffffff", *position, *turn),
        text("/nendo/wrist/left"),
    ]


def main():
    port, mode, count = int(sys.argv[1]), sys.argv[2], int(sys.argv[3])
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def send(*packets):
        for packet in packets:
            sock.sendto(packet, ("127.0.0.1", port))

    chance = random.Random(7)
    sent = 0
    for k in range(count):
        if mode == "whole":
            send(whole("left", k), whole("right", k, "d"))
        elif mode == "bundled":
            send(bundle(None, whole("left", k), message("/other", "i", k), bundle(None, whole("right", k))))
        elif mode == "tagged":
            send(bundle(time.time() - 3.5, whole("left", k)))  # the sender's clock is slow
        elif mode == "phone":
            first, second = phone(k)
            send(message(SENDER + "/deviceinfo", "sf", "a phone", 1.0), first)
            send(second)
        elif mode == "phone-bundle":
            send(bundle(time.time(), message(SENDER + "/deviceinfo", "sf", "a phone", 1.0), *phone(k)))
        elif mode == "hostile":
            for packet in hostile(k, chance):
                send(packet)
                sent += len(packet)
                time.sleep(0.001)  # the inlet reads no faster
            send(whole("left", k))
            sent += len(whole("left", k))
        time.sleep(0.016 if mode.startswith("phone") else 0.004)
    print(sent)


main()
