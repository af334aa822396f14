#!/usr/bin/env python3
"""A Flock of Birds on a pseudo-terminal, for the tests of its driver. Written from the published facts alone.
usage: flock_device.py [--birds 12] [--units N] [--baud 115200] [--rate 103.3] [--scale 0] [--burst N] [--error N] [--odd WHAT]

It answers `heard`, and what device_terminal.py does.

Each record of a bird has a number n: x is 1000 + n % 1000 steps of 1/8192 of the range, y 200 times the address, z is -700,
and the receiver is turned about z by n % 1000 times 2 milliradians. --odd: `streaming` (already, in group mode),
`standby` (never runs), `erc` (unit 1 is an extended range controller), `deaf` (for 2 s, as after a reset)."""
import argparse
import math
import time

import device_terminal

ARGUMENTS = {"L": 2, "O": 1, "M": 1, "H": 12, "J": 12, "r": 6, "q": 6, "0": 1, "A": 1}
CHANGED = {3: 2, 4: 2, 7: 2, 22: 2, 35: 1, 50: 1}
QUIET_S = 0.3  # 0.6 s, less what a busy machine takes


def word(value):
    """A value of 14 bits as two bytes of seven."""
    return bytes([value & 0x7F, value >> 7 & 0x7F])


class Flock:
    def __init__(self, options):
        self.options = options
        self.birds = [int(address) for address in options.birds]
        self.units = options.units or max(self.birds)
        self.out = bytearray()
        self.held = bytearray()
        self.target = 1
        self.format = {}
        self.zenith = {}
        self.group = self.streaming = self.running = options.odd == "streaming"
        if self.running:
            self.format = dict.fromkeys(self.birds, "]")
        self.asleep = False
        self.error = options.error
        self.numbers = dict.fromkeys(self.birds, 0)
        self.heard = []
        self.last_byte = self.begin = self.due = time.monotonic()
        self.quiet = 0.0
        self.spoils_until = 0.0

    def receive(self, data):
        now = time.monotonic()
        if self.options.odd == "deaf" and now < self.begin + 2.0:
            return
        for byte in data:
            if now < self.spoils_until:
                self.running = False
            if not self.held and byte >= 0xF0:
                self.target = byte & 0x0F
                self.last_byte = now
                continue
            if not self.held:
                self.quiet = now - self.last_byte
            self.held.append(byte)
            self.last_byte = now
            if len(self.held) == self.length():
                command, self.held = bytes(self.held), bytearray()
                self.command(chr(command[0]), command[1:], now)
                self.target = 1

    def length(self):
        if self.held[0] != ord("P"):
            return 1 + ARGUMENTS.get(chr(self.held[0]), 0)
        return 2 + CHANGED.get(self.held[1], 0) if len(self.held) > 1 else 3

    def command(self, letter, values, now):
        self.heard.append(f"{self.target}{letter}" + "".join(f".{value}" for value in values))
        if letter == "@":
            self.streaming, self.due = self.runs(), now + 1.0 / self.options.rate
            return
        if self.target == 1:
            self.streaming = False
        if letter == "B":
            self.records()
        elif letter in "FG":
            self.asleep = letter == "G"
        elif letter in "VWXYZ\\]":
            self.format[self.target] = letter
        elif letter == "L":
            self.zenith[self.target] = tuple(values)
        elif letter == "O":
            self.examine(values[0])
        elif letter == "P" and values[0] == 35:
            self.group = values[1] == 1
        elif letter == "P" and values[0] == 50:
            self.running = self.quiet >= QUIET_S and values[1] == self.units and self.options.odd != "standby"
            self.spoils_until = now + QUIET_S

    def runs(self):
        return self.running and not self.asleep

    def examine(self, parameter):
        if parameter == 1:
            self.out += bytes([3, 60])
        elif parameter == 3:
            self.out += bytes([self.options.scale, 0])
        elif parameter == 7:
            hz = round(self.options.rate * 256)
            self.out += bytes([hz & 0xFF, hz >> 8])
        elif parameter == 10:
            self.out.append(self.error)
            self.error = 0
        elif parameter == 15:
            self.out += b"6DERC     " if self.options.odd == "erc" else b"6DFOB     "
        elif parameter == 36:
            state = 0x80 | 0x40 * self.runs()
            self.out += bytes([(state | 0x20 * (k in self.birds)) if k <= self.units else 0 for k in range(1, 15)])

    def records(self):
        if not self.runs():
            return
        for bird in self.birds if self.group else self.birds[:1]:
            number = self.numbers[bird] % 1000
            self.numbers[bird] += 1
            if self.format.get(bird) != "]":
                self.out += bytes([0x80] + [0x11] * (12 if self.group else 11))  # position and angles
                continue
            place = [1000 + number, 200 * bird, -700]
            axis, sign = self.zenith.get(bird, (0, 0))
            if (place[axis // 6] < 0) != (sign == 1):
                place = [-value for value in place]
            half = number / 1000.0
            turn = [math.cos(half), 0.0, 0.0, -math.sin(half)]  # the transmitter's axes to the receiver's
            data = bytearray(b"".join(word(value) for value in place))
            data += b"".join(word(round(value * 8192)) for value in turn)
            data[0] |= 0x80
            if self.group:
                data.append(bird)
            self.out += data

    def advance(self, now):
        cycle = 1.0 / self.options.rate
        if self.streaming and now >= self.due + (self.options.burst - 1) * cycle:
            while self.streaming and now >= self.due:
                self.due += cycle
                self.records()


def answer(flock, _line):
    return " ".join(flock.heard) or "nothing"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--birds", default="12")
    parser.add_argument("--units", type=int, default=0)
    parser.add_argument("--baud", type=int, default=115200)
    parser.add_argument("--rate", type=float, default=103.3)
    parser.add_argument("--scale", type=int, default=0)
    parser.add_argument("--burst", type=int, default=1)
    parser.add_argument("--error", type=int, default=0)
    parser.add_argument("--odd", default="")
    options = parser.parse_args()
    device_terminal.serve(Flock(options), options.baud, options.odd, answer)


if __name__ == "__main__":
    main()
