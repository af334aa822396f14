#!/usr/bin/env python3
"""A Polhemus FASTRAK on a pseudo-terminal, for the tests of its driver. Written from the manual's facts alone.
usage: fastrak_device.py [--plugged 12] [--baud 115200] [--status 55] [--error k] [--burst N] [--odd WHAT]

It answers `counts` and `heard`, and what device_terminal.py does.

Each record of a station has a number n: x is 20 + n % 1000 / 100 cm, y ten times the station, z is -30, and the quaternion
is a turn about z by n % 1000 milliradians. --odd: `inches` (refuses u), `deaf` (no answer to l),
`waiting` (for the rest of a command, at the beginning), `streaming` (already, at the beginning), `refuse` (x and v)."""
import argparse
import math
import struct
import time

import device_terminal

CYCLE_S = 1.0 / 120.0
AT_ONCE = b"PCcFfUuST\x0b\x11\x13\x19W"  # commands that act without a CR
FORBIDDEN = b"\x0bW\x19"


class Unit:
    def __init__(self, options):
        self.options = options
        self.out = bytearray()
        self.held = bytearray(b"O1," if options.odd == "waiting" else b"")
        self.binary = options.odd == "streaming"
        self.metric = False
        self.streaming = options.odd == "streaming"
        self.items = {station: [2, 4, 1] for station in "1234"}
        self.zenith = {station: (1.0, 0.0, 0.0) for station in "1234"}
        self.on = set(options.plugged)
        self.numbers = dict.fromkeys("1234", 0)
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
            self.status()
        elif letter in "Cc":
            self.streaming = letter == "C"
            self.due = time.monotonic() + CYCLE_S
        elif letter in "Ff":
            self.binary = letter == "f"
        elif letter == "U" or (letter == "u" and self.options.odd != "inches"):
            self.metric = letter == "u"
        elif letter == "P":
            for station in sorted(self.on):
                self.record(station)

    def status(self):
        flags = 0x3F0 | self.binary | self.metric << 1 | self.streaming << 3
        name = "FASTRAK emulated in Python" if self.options.status == 55 else "InterSense emulated"
        width = 32 - (55 - self.options.status)
        self.out += f"21S{flags:03X}    F3{len(self.on)}  02.03 {name:<{width}}\r\n".encode()
        self.last_status = flags

    def error(self, text, code):
        self.out += f"2 E*ERROR*{text}*ERROR* EC {code}*PS 1*FL 1*ST 0\r\n".encode()

    def command(self, text):
        self.heard.append(text)
        letter, station, rest = text[:1], text[1:2], text[2:]
        values = rest[1:].split(",") if rest.startswith(",") else []
        if not all(value.lstrip("-").replace(".", "").isdigit() for value in values):
            self.error(text, -2)
        elif letter in "xv" and len(text) > 1:
            if self.options.odd == "refuse":
                self.error(text, -99)
        elif letter not in "lOHIe" or station not in "1234":
            self.error(text, -99)
        elif letter == "l" and not values:
            if self.options.odd != "deaf":
                self.out += f"2{station}l{''.join('01'[s in self.on] for s in '1234')}\r\n".encode()
        elif letter == "l":
            if values == ["1"] and station in self.options.plugged:
                self.on.add(station)
            elif values == ["0"] and len(self.on) > 1:
                self.on.discard(station)
        elif letter == "O" and values:
            self.items[station] = [int(value) for value in values]
        elif letter == "H" and len(values) == 3:
            self.zenith[station] = tuple(float(value) for value in values)

    def pose(self, station, number):
        position = [20.0 + number % 1000 / 100.0, 10.0 * int(station), -30.0]
        side = sum(a * b for a, b in zip(position, self.zenith[station]))
        if side < 0:
            position = [-value for value in position]
        if not self.metric:
            position = [value / 2.54 for value in position]
        half = number % 1000 / 2000.0
        return position, [math.cos(half), 0.0, 0.0, math.sin(half)]

    def record(self, station):
        position, quaternion = self.pose(station, self.numbers[station])
        self.numbers[station] += 1
        self.sent += 1
        data = bytearray(b"0" + station.encode() + self.options.error.encode())
        for item in self.items[station]:
            if item == 1:
                data += b"\r\n"
            elif item == 0:
                data += b" "
            else:
                numbers = {2: position, 11: quaternion, 4: [0.0, 0.0, 0.0]}[item]
                if self.binary:
                    data += struct.pack(f"<{len(numbers)}f", *numbers)
                else:
                    data += "".join(f"{number:7.2f}" if item != 11 else f"{number:7.4f}" for number in numbers).encode()
        self.out += data

    def advance(self, now):
        if self.streaming and now >= self.due + self.options.burst * CYCLE_S - CYCLE_S:
            while self.streaming and now >= self.due:
                self.due += CYCLE_S
                stations = sorted(self.on)
                self.turn = (self.turn + 1) % len(stations)
                self.record(stations[self.turn])


def answer(unit, line):
    if line == "counts":
        return f"sent {unit.sent} forbidden {unit.forbidden} on {''.join(sorted(unit.on))}"
    return " ".join(unit.heard).replace("\n", "?")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--plugged", default="1234")
    parser.add_argument("--baud", type=int, default=115200)
    parser.add_argument("--status", type=int, default=55)
    parser.add_argument("--error", default=" ")
    parser.add_argument("--burst", type=int, default=1)
    parser.add_argument("--odd", default="")
    options = parser.parse_args()
    device_terminal.serve(Unit(options), options.baud, options.odd, answer)


if __name__ == "__main__":
    main()
