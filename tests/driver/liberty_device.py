#!/usr/bin/env python3
"""A Polhemus LIBERTY, PATRIOT or Latus on a pseudo-terminal, for the tests of its driver. Written from published facts alone.
usage: liberty_device.py [--model PA] [--stations 2] [--baud 115200] [--error C] [--distortion N] [--skip N] [--whole] [--odd WHAT]

It answers `counts` and `heard`, and what device_terminal.py does. --skip drops each N-th frame, --whole counts the header in
the length. Frame n of station s: x is 20 + n % 1000 / 100 cm, y ten times the station, z is -30, and the quaternion is a turn
about z by n % 1000 milliradians. --odd: `old` (does not know the items), `waiting` (for the rest of a command, at
the beginning), `streaming` (already, at the beginning)."""
import argparse
import math
import struct
import time

import device_terminal

RATES = {"LY": 240.0, "PA": 60.0, "LU": 188.0}
NAMES = {"LY": "LIBERTY", "PA": "PATRIOT", "LU": "LATUS"}


class Unit:
    def __init__(self, options):
        self.options = options
        self.out = bytearray()
        self.held = bytearray(b"O1," if options.odd == "waiting" else b"")
        self.binary = self.streaming = options.odd == "streaming"
        self.metric = False
        self.items = [2, 4, 1]
        self.zenith = (1.0, 0.0, 0.0)
        self.frame = self.sent = 0
        self.zero = self.due = time.monotonic()
        self.period = 1.0 / RATES[options.model]
        self.heard = []

    def receive(self, data):
        for byte in data:
            if not self.held and byte == ord("P"):
                self.streaming = False
                self.records("P")
            elif byte == 0x0D:
                text, self.held = self.held.decode("latin-1"), bytearray()
                if text:
                    self.heard.append(text)
                    self.command(text[0], text[1:])
            else:
                self.held.append(byte)

    def frame_of(self, command, station, error, body):
        if self.binary:
            length = len(body) + (8 if self.options.whole and command in "CP" else 0)
            self.out += self.options.model.encode() + struct.pack("<BcBBH", station, command.encode(), error, 0, length) + body
        else:
            self.out += f"{station:02d}{command}{chr(error)}".encode() + body

    def command(self, letter, rest):
        if letter == "F":
            self.binary = rest == "1"
        elif letter == "C":
            self.streaming = True
            self.due = time.monotonic() + self.period
        elif letter == "U":
            self.metric = rest == "1"
        elif letter == "O" and rest.startswith("*,") and self.options.odd != "old":
            self.items = [int(item) for item in rest[2:].split(",")]
        elif letter == "H":
            self.zenith = tuple(float(value) for value in rest[2:].split(","))
        elif letter == "Q":
            self.zero = time.monotonic()
        elif letter == "\x16":
            text = f"{NAMES[self.options.model]} Polhemus emulated\r\nfirmware 1.2.3 " + "serial number 4711 " * 8
            self.frame_of("\x16", 0, 0x20, text[:190].encode() + b"\r\n")
        elif letter == "\x15":
            there = (1 << self.options.stations) - 1
            self.frame_of("\x15", 0, 0x20, struct.pack("<HH", there | 0x100, there))

    def body(self, station):
        number = self.frame % 1000
        position = [20.0 + number / 100.0, 10.0 * station, -30.0]
        if sum(a * b for a, b in zip(position, self.zenith)) < 0:
            position = [-value for value in position]
        if not self.metric:
            position = [value / 2.54 for value in position]
        half = number / 2000.0
        time_ms = int((time.monotonic() - self.zero) * 1000)
        parts = {0: b" ", 1: b"\r\n", 2: struct.pack("<3f", *position), 3: struct.pack("<3f", *position),
                 4: struct.pack("<3f", 0, 0, 0), 7: struct.pack("<4f", math.cos(half), 0, 0, math.sin(half)),
                 8: struct.pack("<I", time_ms), 9: struct.pack("<I", self.frame), 11: struct.pack("<i", self.options.distortion)}
        return b"".join(parts[item] for item in self.items)

    def records(self, command):
        for station in range(1, self.options.stations + 1):
            self.frame_of(command, station, ord(self.options.error), self.body(station))
            self.sent += command == "C"
        self.frame += 1

    def advance(self, now):
        while self.streaming and now >= self.due:
            self.due += self.period
            if self.options.skip and self.frame % self.options.skip == self.options.skip - 1:
                self.frame += 1
            else:
                self.records("C")


def answer(unit, line):
    if line == "counts":
        return f"sent {unit.sent} metric {unit.metric}"
    return " ".join(unit.heard).encode("unicode_escape").decode()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--model", default="PA")
    parser.add_argument("--stations", type=int, default=2)
    parser.add_argument("--baud", type=int, default=115200)
    parser.add_argument("--error", default=" ")
    parser.add_argument("--distortion", type=int, default=0)
    parser.add_argument("--skip", type=int, default=0)
    parser.add_argument("--whole", action="store_true")
    parser.add_argument("--odd", default="")
    options = parser.parse_args()
    device_terminal.serve(Unit(options), options.baud, options.odd, answer)


if __name__ == "__main__":
    main()
