#!/usr/bin/env python3
"""A host that talks to an emulated Flock of Birds of two birds, at rest, and checks each command. Written from the published
facts alone. usage: flock_host.py TERMINAL

It ends with status 0 and the number of checks, or with status 1 and the first answer that is wrong."""
import os
import select
import sys
import termios
import time
import tty

LENGTHS = {"V": 6, "W": 6, "X": 18, "Y": 12, "Z": 24, "\\": 8, "]": 14}
HALVES = {(0, 0): (0, 1), (0, 1): (0, -1), (6, 0): (1, 1), (6, 1): (1, -1), (12, 0): (2, 1), (12, 1): (2, -1)}
checks = 0


def check(good, what):
    global checks
    checks += 1
    if not good:
        sys.exit(f"flock_host.py: {what}")


class Line:
    def __init__(self, path):
        self.fd = os.open(path, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self.fd)
        mode = termios.tcgetattr(self.fd)
        mode[4] = mode[5] = termios.B115200
        termios.tcsetattr(self.fd, termios.TCSANOW, mode)

    def read(self, seconds):
        """All bytes of so much time."""
        data, end = b"", time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            if select.select([self.fd], [], [], left)[0]:
                data += os.read(self.fd, 65536)
        return data

    def ask(self, *parts, count=None):
        """Sends the bytes; returns what comes until `count` bytes have come, or for 0.15 s."""
        message = b"".join(part.encode() if isinstance(part, str) else bytes([part]) for part in parts)
        os.write(self.fd, message)
        if count is None:
            return self.read(0.15)
        data, end = b"", time.monotonic() + 2.0
        while len(data) < count and time.monotonic() < end:
            data += self.read(0.02)
        return data + self.read(0.05)


def values(record):
    """The values of a record, from -1 to 1."""
    result = []
    for low, high in zip(record[0::2], record[1::2]):
        bits = ((high & 0x7F) << 7 | low & 0x7F) << 2
        result.append((bits - 65536 if bits >= 32768 else bits) / 32768.0)
    return result


def check_phase(data, length, what):
    check(len(data) % length == 0, f"{what}: {len(data)} bytes are no records of {length}")
    for at, byte in enumerate(data):
        check((byte >= 0x80) == (at % length == 0), f"{what}: bit 7 of byte {at}")


def before_configuration(line):
    states = line.ask("O", 36, count=14)
    check(states == bytes([0xA1, 0xA0] + [0] * 12), f"units before configuration: {states.hex()}")
    check(line.ask("B") == b"", "a record before configuration")
    check(line.ask("O", 10, count=1) == b"\x1d", "error 29, transmitter off")
    check(line.ask("O", 10, count=1) == b"\x00", "reading clears the error")
    time.sleep(0.7)
    check(line.ask("P", 50, 5) == b"", "the configuration answers")
    time.sleep(0.7)
    check(line.ask("O", 16, count=2)[0] == 13, "units that are not there: error 13")
    check(line.ask("O", 36, count=14)[0] == 0xA1, "runs with a wrong number of units")
    line.ask("P", 50, 2)  # no quiet before
    check(line.ask("O", 36, count=14)[0] == 0xA1, "runs without the quiet before the configuration")
    line.ask("O", 10, count=1)


def configure(line):
    time.sleep(0.7)
    line.ask("P", 50, 2)
    time.sleep(0.7)
    states = line.ask("O", 36, count=14)
    check(states == bytes([0xE1, 0xE0] + [0] * 12), f"units after configuration: {states.hex()}")
    check(line.ask("O", 10, count=1) == b"\x00", "an error after the configuration")


def formats(line):
    record = line.ask("B", count=12)
    check(len(record) == 12, "position and angles are the default")
    for letter, length in LENGTHS.items():
        check(line.ask(letter) == b"", f"{letter} answers")
        record = line.ask("B", count=length)
        check(len(record) == length, f"{letter}: {len(record)} bytes")
        check_phase(record, length, letter)
    place_and_turn = values(line.ask("B", count=14))
    place = [value * 36 * 0.0254 for value in place_and_turn[:3]]
    check(abs(place[0] - 0.34) < 0.001 and abs(place[1] + 0.2) < 0.001 and abs(place[2] + 0.125) < 0.001, f"place {place}")
    check(abs(abs(place_and_turn[3]) - 1) < 0.001, "a hand at rest is not turned")
    line.ask("X")
    matrix = values(line.ask("B", count=18))
    check(all(abs(abs(matrix[k]) - (k % 4 == 0)) < 0.001 for k in range(9)), f"matrix {matrix}")
    line.ask("W")
    check(all(abs(angle) < 0.001 for angle in values(line.ask("B", count=6))), "angles")
    line.ask("]")
    other = line.ask(0xF2, "]", 0xF2, "B", count=14)
    check(abs(values(other)[1] * 36 * 0.0254 - 0.2) < 0.001, "the second bird's record by its address")
    line.ask("M", 1)
    check(line.ask("B", count=15)[14:] == b"\x00", "the byte of the buttons")
    line.ask("M", 0)
    check(len(line.ask("B", count=14)) == 14, "no byte of the buttons")
    check(line.ask("N", count=1) == b"\x00", "the buttons once")


def parameters(line):
    for number, size in ((0, 2), (1, 2), (2, 2), (3, 2), (4, 2), (7, 2), (10, 1), (15, 10), (16, 2), (19, 1), (22, 2), (35, 1),
                         (36, 14)):
        check(len(line.ask("O", number, count=size)) == size, f"parameter {number}")
    check(line.ask("O", 15, count=10) == b"6DFOB     ", "the model")
    rate = line.ask("O", 7, count=2)
    check(abs((rate[0] + 256 * rate[1]) / 256 - 103.3) < 0.01, "the rate")
    before = values(line.ask("B", count=14))
    line.ask("P", 3, 1, 0)
    after = values(line.ask("B", count=14))
    check(line.ask("O", 3, count=2) == b"\x01\x00", "the scale")
    check(all(abs(b - 2 * a) < 0.002 for b, a in zip(before[:3], after[:3])), "the double range halves the values")
    line.ask("P", 3, 0, 0)
    line.ask("P", 4, 5, 6)
    check(line.ask("O", 4, count=2) == b"\x05\x06", "the filters")
    line.ask("k")
    check(line.ask("O", 10, count=1) == b"\x06", "an unknown command is error 6")
    line.ask("O", 77)
    check(line.ask("O", 10, count=1) == b"\x06", "an unknown parameter is error 6")
    line.ask(0xF7, "]")
    check(line.ask("O", 16, count=2) == b"\x0d\x07", "no unit at address 7")
    line.ask("O", 10, count=1)
    for letter, count in (("H", 12), ("J", 12), ("r", 6), ("q", 6), ("0", 1), ("A", 1)):
        check(line.ask(letter, *[ord("B")] * count) == b"", f"{letter} takes {count} bytes")
    check(line.ask("O", 10, count=1) == b"\x00", "an error after commands that are heard")


def hemispheres(line):
    for (axis, sign), (k, wanted) in HALVES.items():
        line.ask("L", axis, sign)
        check(line.ask("O", 22, count=2) == bytes([axis, sign]), "the hemisphere")
        check(values(line.ask("B", count=14))[k] * wanted > 0, f"hemisphere {axis} {sign}")
    line.ask("L", 0, 0)
    line.ask("L", 3, 0)
    check(line.ask("O", 10, count=1) == b"\x06", "a hemisphere that is none")


def rate_of(line, command, wanted_hz):
    """The records of each bird per second, of a stream in group mode, which a B ends. The machine may be busy."""
    for _ in range(5):
        rate = measured_rate(line, command)
        if abs(rate - wanted_hz) < 0.05 * wanted_hz:
            break
    return rate


def measured_rate(line, command, seconds=2.0):
    line.ask(command, count=1)
    begin = time.monotonic()
    data = line.read(seconds)
    rate = len(data) / 30 / (time.monotonic() - begin)
    tail = line.ask("B", count=30)
    check(line.read(0.3) == b"", "records after the stream's end")
    while data and data[0] < 0x80:
        data = data[1:]
    data += tail
    check_phase(data, 15, "stream")
    addresses = data[14::15]
    check(set(addresses) == {1, 2}, "the addresses of a group's records")
    check(all(a != b for a, b in zip(addresses, addresses[1:])), "birds take turns")
    return rate


def streams(line):
    line.ask("P", 35, 1)
    record = line.ask("B", count=30)
    check(len(record) == 30 and record[14] == 1 and record[29] == 2, "one record of each bird with its address")
    for command, hz in (("@", 103.3), ("Q", 103.3), ("R", 51.65), ("S", 12.9)):
        rate = rate_of(line, command, hz)
        check(abs(rate - hz) < 0.05 * hz, f"{command}: {rate} Hz")
    line.ask("T", count=1)
    check(len(line.read(1.0)) in (60, 90, 120), "every 32nd cycle")
    line.ask("B", count=30)
    line.ask("P", 7, 0, 50)
    rate = rate_of(line, "@", 50)
    check(abs(rate - 50) < 2.5, f"{rate} Hz of 50")
    line.ask("@", count=1)
    os.write(line.fd, b"\x13")  # XOFF
    line.read(0.1)
    check(line.read(0.3) == b"", "records after XOFF")
    os.write(line.fd, b"\x11")
    check(len(line.read(0.3)) > 100, "no records after XON")
    line.ask("G")
    check(line.read(0.3) == b"" and line.ask("B") == b"", "records of a flock that sleeps")
    line.ask("F")
    check(len(line.ask("B", count=30)) == 30, "no record of a flock that was woken")
    line.ask("@", count=1)
    line.ask(0xF2, "L", 0, 0)
    check(len(line.read(0.3)) > 100, "a command for one bird ends the stream")
    line.ask("/")
    line.read(0.8)
    check(line.ask("O", 36, count=14)[0] == 0xA1, "the flock runs after a reset")
    check(line.ask("O", 35, count=1) == b"\x00", "group mode after a reset")


def main():
    line = Line(sys.argv[1])
    before_configuration(line)
    configure(line)
    formats(line)
    parameters(line)
    hemispheres(line)
    streams(line)
    print(checks, "checks")


if __name__ == "__main__":
    main()
