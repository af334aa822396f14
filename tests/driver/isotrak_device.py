#!/usr/bin/env python3
"""A Polhemus ISOTRAK II on a pseudo-terminal, for the tests of its driver. Written from published facts alone.
usage: isotrak_device.py [--plugged 12] [--baud 115200] [--third C] [--burst N] [--odd WHAT]

It answers `counts` and `heard`, and what device_terminal.py does.

Each record of a station has a number n: x is 20 + n % 1000 / 100 cm, y ten times the station, z is -30, and the quaternion
is a turn about z by n % 1000 milliradians. An earlier program has left an alignment, which moves all positions, and a
boresight, which turns all quaternions. --third: what is in a record's third byte. --odd: `old` (does not know the quaternion),
`waiting` (for the rest of a command, at the beginning), `streaming` (already, at the beginning), `refuse` (x and v)."""
import argparse
import math
import struct
import time

import device_terminal

CYCLE_S = 1.0 / 60.0
RANGE_CM = 166.32
AT_ONCE = b"PCcFfUuST\x0b\x11\x13\x19W"  # commands that act without a CR
FORBIDDEN = b"\x0bW\x19"


def packed(plain):
    """Bytes as groups of up to seven, each followed by their high bits; the first byte of all has bit 7 set."""
    out = bytearray()
    for begin in range(0, len(plain), 7):
        group = plain[begin:begin + 7]
        out += bytes(byte & 0x7F for byte in group)
        out.append(sum((byte >> 7) << k for k, byte in enumerate(group)))
    out[0] |= 0x80
    return out


class Unit:
    def __init__(self, options):
        self.options = options
        self.out = bytearray()
        self.held = bytearray(b"H1," if options.odd == "waiting" else b"")
        self.binary = self.streaming = options.odd == "streaming"
        self.metric = False
        self.items = [2, 4, 1]
        self.zenith = {station: (1.0, 0.0, 0.0) for station in "12"}
        self.aligned, self.boresighted = set("12"), set("12")
        self.on = set(options.plugged)
        self.numbers = dict.fromkeys("12", 0)
        self.sent = self.forbidden = 0
        self.heard = []
        self.turn = 0
        self.due = time.monotonic()

    def receive(self, data):
        for byte in data:
            self.forbidden += byte in FORBIDDEN
            if not self.held and byte in AT_ONCE:
                self.at_once(chr(byte))
            elif byte == 0x0D:
                text, self.held = self.held.decode("latin-1"), bytearray()
                if text:
                    self.command(text)
            else:
                self.held.append(byte)

    def at_once(self, letter):
        self.heard.append(letter)
        if letter == "S":
            flags = 0x3F0 | self.binary | self.metric << 1 | self.streaming << 3
            self.out += f"21S{flags:03X}    1.10 ISO \r\n".encode()
        elif letter in "Cc":
            self.streaming = letter == "C"
            self.due = time.monotonic() + CYCLE_S
        elif letter in "Ff":
            self.binary = letter == "f"
        elif letter in "Uu":
            self.metric = letter == "u"
        elif letter == "P":
            for station in sorted(self.on):
                self.record(station)

    def error(self, text, code):
        self.out += f"2 E*ERROR*{text}*ERROR* EC {code}*PS 1*FL 1*ST 0\r\n".encode()

    def command(self, text):
        self.heard.append(text)
        letter, station, values = text[0], text[1:2], text[3:].split(",")
        if not all(value.lstrip("-").replace(".", "").isdigit() for value in text[1:].split(",")):
            self.error(text, -2)
        elif letter == "O":
            items = [int(item) for item in text[1:].split(",")]
            if self.options.odd == "old" and 11 in items:
                self.error(text, -3)
            else:
                self.items = items
        elif letter in "xv":
            if self.options.odd == "refuse":
                self.error(text, -99)
        elif letter not in "lHRb" or station not in set("12"):
            self.error(text, -99)
        elif letter == "l" and values == ["1"]:
            self.on |= {station} & set(self.options.plugged)
        elif letter == "l" and values == ["0"] and len(self.on) > 1:
            self.on.discard(station)
        elif letter == "H" and len(values) == 3:
            self.zenith[station] = tuple(float(value) for value in values)
        elif letter == "R":
            self.aligned.discard(station)
        elif letter == "b":
            self.boresighted.discard(station)

    def pose(self, station, number):
        position = [20.0 + number % 1000 / 100.0, 10.0 * int(station), -30.0]
        if sum(a * b for a, b in zip(position, self.zenith[station])) < 0:
            position = [-value for value in position]
        if station in self.aligned:
            position[1] += 5.0
        if not self.metric:
            position = [value / 2.54 for value in position]
        half = number % 1000 / 2000.0 + (0.1 if station in self.boresighted else 0.0)
        return position, [math.cos(half), 0.0, 0.0, math.sin(half)]

    def record(self, station):
        position, quaternion = self.pose(station, self.numbers[station])
        self.numbers[station] += 1
        self.sent += 1
        data = bytearray(b"0" + station.encode() + self.options.third.encode())
        for item in self.items:
            if item == 1:
                data += b"\r\n"
                continue
            numbers, scale = {2: (position, RANGE_CM), 11: (quaternion, 1.0), 4: ([0.0, 0.0, 0.0], 180.0)}[item]
            for number in numbers:
                if self.binary:
                    data += struct.pack("<h", round(number / scale * 32767))
                else:
                    data += (f"{number:7.4f}" if item == 11 else f"{number:7.2f}").encode()
        self.out += packed(data) if self.binary else data

    def advance(self, now):
        if self.streaming and now >= self.due + (self.options.burst - 1) * CYCLE_S:
            while now >= self.due:
                self.due += CYCLE_S
                stations = sorted(self.on)
                self.turn = (self.turn + 1) % len(stations)
                self.record(stations[self.turn])


def answer(unit, line):
    if line == "counts":
        return f"sent {unit.sent} forbidden {unit.forbidden} on {''.join(sorted(unit.on))}"
    return " ".join(unit.heard).encode("unicode_escape").decode()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--plugged", default="12")
    parser.add_argument("--baud", type=int, default=115200)
    parser.add_argument("--third", default="*")
    parser.add_argument("--burst", type=int, default=1)
    parser.add_argument("--odd", default="")
    options = parser.parse_args()
    device_terminal.serve(Unit(options), options.baud, options.odd, answer)


if __name__ == "__main__":
    main()
