#!/usr/bin/env python3
"""usage: fastrak_host.py PORT orbit|rest|cross|slow

A host of a FASTRAK of its own: it was written from the manual's tables, and not from the driver or the emulated unit. It sends
every command, finds the records in the bytes itself, and compares the poses with the description of the motions. It prints what
is wrong and exits with 1.
"""

import math
import os
import select
import struct
import sys
import termios
import time
import tty

STATUS_BYTES = 55
# Bytes of each item in text and in binary.
ITEMS = {0: (1, 1), 1: (2, 2), 2: (21, 12), 4: (21, 12), 5: (21, 12), 6: (21, 12), 7: (21, 12), 11: (28, 16), 16: (2, 2),
         50: (1, 1), 51: (2, 2), 52: (39, 12), 54: (39, 12), 55: (39, 12), 56: (39, 12), 57: (39, 12), 61: (52, 16), 66: (2, 2)}
NUMBERS = {2: 3, 4: 3, 5: 3, 6: 3, 7: 3, 11: 4}
RESTART, SAVE = b"\x19", b"\x0b"


class Port:
    def __init__(self, path, speed):
        self.fd = os.open(path, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self.fd)
        line = termios.tcgetattr(self.fd)
        line[4] = line[5] = speed
        termios.tcsetattr(self.fd, termios.TCSANOW, line)

    def send(self, command):
        os.write(self.fd, command if isinstance(command, bytes) else command.encode())

    def some(self, quiet_s):
        """Whatever comes within this time; empty if nothing does."""
        return os.read(self.fd, 65536) if select.select([self.fd], [], [], quiet_s)[0] else b""

    def read_until(self, enough, timeout_s=20.0):
        """What comes until enough(it); less after the timeout. It is long, because machines can be busy."""
        data, end = b"", time.monotonic() + timeout_s
        while not enough(data) and time.monotonic() < end:
            data += self.some(0.05)
        return data

    def read(self, count, timeout_s=20.0):
        return self.read_until(lambda data: len(data) >= count, timeout_s)

    def ask(self, command, lines=1):
        """The answer of so many lines."""
        self.send(command)
        return self.read_until(lambda data: data.count(b"\r\n") >= lines)

    def before_status(self, command):
        """What comes after the command and before the answer to S."""
        self.send((command if isinstance(command, bytes) else command.encode()) + b"S")
        data = self.read_until(lambda data: data[-STATUS_BYTES:].startswith(b"21S") and data.endswith(b"\r\n"))
        return data[:-STATUS_BYTES]

    def set(self, command):
        """Sends a command that is not answered."""
        answer = self.before_status(command)
        check(answer == b"", f"{command!r} was answered by {answer!r}")


class Record:
    """A data record's fields, by item."""

    def __init__(self, data, items, binary):
        self.station, self.error = data[1] - ord("0"), chr(data[2])
        self.values, at = {}, 3
        for item in items:
            size = ITEMS[item][binary]
            field = data[at:at + size]
            at += size
            short = item - 50 if item >= 50 else item
            if short in NUMBERS:
                self.values[short] = numbers(field, NUMBERS[short], binary)
            else:
                self.values[short] = field


def numbers(field, count, binary):
    if binary:
        return struct.unpack(f"<{count}f", field)
    width = len(field) // count
    return [float(field[k * width:(k + 1) * width]) for k in range(count)]


def record_bytes(items, binary):
    return 3 + sum(ITEMS[item][binary] for item in items)


def records(data, items, binary):
    """Cuts a stream into records. Each must begin as a record does."""
    size = record_bytes(items, binary)
    found = []
    for at in range(0, len(data) - size + 1, size):
        check(data[at] == ord("0") and data[at + 1] in b"1234", f"no record at byte {at}: {data[at:at + size]!r}")
        found.append(Record(data[at:at + size], items, binary))
    return found


def check(good, what):
    if not good:
        sys.exit(f"fastrak_host: {what}")


def near(got, wanted, step, what):
    check(len(got) == len(wanted) and all(abs(a - b) <= step for a, b in zip(got, wanted)),
          f"{what}: {list(got)}, and not {list(wanted)} within {step}")


def status(port):
    data = port.ask("S")
    check(len(data) == STATUS_BYTES and data.startswith(b"21S") and data.endswith(b"\r\n") and data[10:12] == b"F3",
          f"status {data!r}")
    return int(data[3:6], 16)


def polled(port, items, binary, stations):
    """One record of each station, after P."""
    size = record_bytes(items, binary)
    port.send("P")
    data = port.read(size * len(stations))
    check(len(data) == size * len(stations), f"P: {len(data)} bytes of {size * len(stations)}: {data!r}")
    found = records(data, items, binary)
    check([record.station for record in found] == list(stations), "P: other stations or another order")
    return found


def set_items(port, stations, items):
    for station in stations:
        text = ",".join(str(item) for item in items)
        port.set(f"O{station},{text}\r")
        back = f"2{station}O".encode() + b"".join(b"%2d" % item for item in items) + b"\r\n"
        check(port.ask(f"O{station}\r") == back, f"O{station} is not read back")


def stream(port, count, size):
    """The bytes of so many records of a stream, which is then ended. Never the first second: it is slower."""
    port.send("C")
    data = port.read(count * size)
    data += port.before_status("c")
    check(len(data) >= count * size, f"C: {len(data)} bytes of {count * size}")
    check(len(data) % size == 0, f"C, c: {len(data)} bytes are no whole records of {size}")
    return data


# The motions, as simulated/wrist_motion.hpp describes them. The wrist is 6 cm before the receiver and 2.5 cm below it.
def turned(angle, x, y):
    return (x * math.cos(angle) - y * math.sin(angle), x * math.sin(angle) + y * math.cos(angle))


def side(station):
    return -1 if station % 2 else 1


def orbit_cm(station, angle):
    """Where the receiver is after this turn: 30 cm beside (50, 0, -10), walking round it."""
    x, y = turned(angle, -6.0, 30.0 * side(station))
    return (50.0 + x, y, -12.5)


def rest_cm(station):
    return (34.0, 20.0 * side(station), -12.5)


TREMOR_CM = 0.03


def orbit(port):
    stations = [1, 2, 3, 4]
    port.set("c")
    port.set("\r")
    check(status(port) & 0xF == 0, "the status at power-up")
    check(port.ask("l1\r") == b"21l1111\r\n", "l1: not all stations are on")
    port.set("u")
    check(status(port) & 2 == 2, "u: no centimetres")
    port.set("e1,0\r")
    for command in ("x0.2,0.2,0.8,0.8\r", "v.2,2.E-01,0.8,+0.8\r", "y0\r"):
        port.set(command)
    for station in stations:
        port.set(f"I{station},0\rH{station},1,0,0\r")
    time.sleep(1.0)  # the orbit begins from rest

    for binary in (0, 1):
        port.set("f" if binary else "F")
        check(status(port) & 1 == binary, "F, f: the status")
        for scale in (1.0, 2.54):
            port.set("u" if scale == 1.0 else "U")
            check(bool(status(port) & 2) == (scale == 1.0), "u, U: the status")
            check_items(port, binary, scale)
    port.set("u")

    items = [2, 11, 1]
    set_items(port, stations, items)
    size = record_bytes(items, 1)
    for active in (1, 2, 3, 4):
        for station in stations:
            port.set(f"l{station},{int(station <= active)}\r")
        check(port.ask("l1\r") == b"21l" + b"1" * active + b"0" * (4 - active) + b"\r\n", "l: the stations")
        found = records(stream(port, 60, size), items, 1)
        for before, after in zip(found, found[1:]):
            check(after.station == before.station % active + 1, "the order of the stations")
        of_first = [record for record in found if record.station == 1]
        for before, after in zip(of_first, of_first[1:]):
            step_deg = math.degrees(turn_of(after) - turn_of(before)) % 360.0
            check(abs(step_deg - 30.0 * active / 120.0) < 0.001, f"{active} stations: {step_deg} degrees between records")
        for record in found:
            near(record.values[2], orbit_cm(record.station, turn_of(record)), 2e-4, "a place in a stream")
    before = time.monotonic()
    stream(port, 240, size)
    check(time.monotonic() - before > 1.9, "240 records came in less than 2 s")


def turn_of(record):
    w, x, y, z = record.values[11]
    check(abs(w * w + x * x + y * y + z * z - 1.0) < 0.002, "the norm of a quaternion")
    return 2.0 * math.atan2(z, w)


def check_items(port, binary, scale):
    """The items agree with each other, and the place with the turn, within the step of the format."""
    for items in ([0, 2, 4, 5, 6, 7, 11, 16, 1], [50, 52, 54, 61, 66, 51], [11, 55, 56, 57, 2, 4, 0, 16, 1]):
        set_items(port, [1, 2, 3, 4], items)
        for record in polled(port, items, binary, [1, 2, 3, 4]):
            values = record.values
            check(record.error == " ", f"the error {record.error!r}")
            check(values.get(0, b" ") == b" " and values[1] == b"\r\n" and values[16] == b" 0", "the marks")
            angle = turn_of(record)
            place_cm = [scale * value for value in values[2]]
            is_long = binary or 52 in items
            # Half a step of the place, and of the quaternion's 4 or 6 digits at 60 cm.
            slack = 5e-5 * scale + 1e-4 if is_long else 0.005 * scale + 60.0 * 1e-4
            near(place_cm, orbit_cm(record.station, angle), slack, "a place")
            turn_error = math.remainder(values[4][0] - math.degrees(angle), 360.0)
            check(abs(turn_error) < (0.001 if is_long else 0.02), "the azimuth")
            near(values[4][1:], (0.0, 0.0), 1e-4, "elevation and roll")
            c, s = math.cos(angle), math.sin(angle)
            for item, axis in ((5, (c, s, 0.0)), (6, (-s, c, 0.0)), (7, (0.0, 0.0, 1.0))):
                if item in values:
                    near(values[item], axis, 2.5e-4, f"direction cosines {item}")


def rest(port):
    items = [2, 4, 1]
    port.set("c")
    text = port.ask("P", lines=2)
    check(len(text) == 2 * 47 and text[2:3] == b"k", f"the error letter and the default list: {text!r}")
    check(chr(port.ask("S")[6]) == "k", "the error in the status")
    port.set("u")
    test = port.ask("T")
    check(test.startswith(b"2 T") and test[3:6].isdigit() and test.endswith(b"\r\n"), f"T: {test!r}")
    for record in polled(port, items, 0, [1, 2]):
        check(record.error == " ", "T did not clear the error")
        near(record.values[2], rest_cm(record.station), TREMOR_CM + 0.006, "the place at rest")

    def pose(command, place, angles):
        port.set(command)
        record = polled(port, items, 0, [1, 2])[0]
        near(record.values[2], place, TREMOR_CM + 0.006, command)
        near(record.values[4], angles, 0.006, command)

    pose("r1,90,0,0\r", (20.0, 34.0, -12.5), (90, 0, 0))  # the transmitter is mounted a quarter turn to the right
    pose("B1\r", (20.0, 34.0, -12.5), (0, 0, 0))
    pose("b1\r", (20.0, 34.0, -12.5), (90, 0, 0))
    pose("G1,10,20,30\rB1\r", (20.0, 34.0, -12.5), (10, 20, 30))
    pose("b1\rr1,0,0,0\r", (34.0, -20.0, -12.5), (0, 0, 0))
    pose("N1,1,2,3\r", (35.0, -18.0, -9.5), (0, 0, 0))
    pose("N1,0,0,0\r", (34.0, -20.0, -12.5), (0, 0, 0))
    pose("A1,10,0,0,20,0,0,10,10,0\r", (24.0, -20.0, -12.5), (0, 0, 0))
    pose("R1\r", (34.0, -20.0, -12.5), (0, 0, 0))
    pose("H1,-1,0,0\r", (-34.0, 20.0, 12.5), (0, 0, 0))
    pose("H1,0,0,0\r", (-34.0, 20.0, 12.5), (0, 0, 0))  # tracked from there
    pose("H1,1,0,0\r", (34.0, -20.0, -12.5), (0, 0, 0))

    port.set("I1,1\rI2,1\r")
    port.send("C")
    time.sleep(0.3)
    check(len(port.before_status("c")) == 2 * 47, "a still receiver with I1,1 must send one record")
    port.set("I1,0\rI2,0\r")
    wrong = ((b"!", b"!", -99), (b"O\r", b"O", -1), (b"O1,a\r", b"O1,a", -2), (b"H9,1,0,0\r", b"H9,1,0,0", -3),
             (b"H1,1,0,0,0,0\r", b"H1,1,0,0,0,0", -5))
    for command, text, code in wrong:
        answer = port.ask(command)
        check(answer.startswith(b"2 E*ERROR*" + text + b"*ERROR* EC") and str(code).encode() in answer and
              all(mark in answer for mark in (b"*PS", b"*FL", b"*ST")), f"{command!r}: {answer!r}")

    port.set(SAVE)
    port.set("UfO1,2,1\rl2,0\r")
    check(status(port) & 3 == 1, "U, f: the status")
    port.send(RESTART + b"S")
    check(port.read(1, 0.4) == b"", "it hears while it restarts")
    while not (answer := port.some(0.2)):
        port.send("S")
    port.read_until(lambda data: (len(answer) + len(data)) % STATUS_BYTES == 0)
    check(status(port) & 3 == 2, "the EEPROM had centimetres and text")
    check(port.ask("l1\rO1\r", lines=2) == b"21l1100\r\n21O 2 4 1\r\n", "the EEPROM's list, the stations at power-up")
    port.set("W")
    check(status(port) & 3 == 0, "W: inches and text")


def cross(port):
    items = [2, 11, 1]
    port.set("cfu")
    set_items(port, [1, 2], items)
    for tracked in (False, True):
        port.set("H1,0,0,0\rH2,0,0,0\r" if tracked else "H1,1,0,0\rH2,1,0,0\r")
        found = records(stream(port, 540, record_bytes(items, 1)), items, 1)  # more than a whole turn of 4 s
        sides = set()
        for record in found:
            x, y, z = record.values[2]
            sign = 1.0 if z < 0.0 else -1.0
            sides.add(sign)
            near((sign * y, sign * z), (25.0 * side(record.station), -17.5), 1e-4, "beside the way")
            check(-36.0001 <= sign * x <= 24.0001, "beyond the way")
            check(tracked or x >= 0.0, f"x = {x} in the hemisphere of x")
        check(len(sides) == 1 if tracked else len(sides) == 2, f"tracked {tracked}: the signs {sides}")


def slow(port):
    """33 bytes at 38,400 baud take 8.6 ms, and a cycle 8.33 ms: the next station's solution is always dropped."""
    items = [2, 11, 1]
    port.set("cfu")
    set_items(port, [1, 2], items)
    time.sleep(1.0)
    found = records(stream(port, 60, record_bytes(items, 1)), items, 1)
    for before, after in zip(found, found[1:]):
        check(after.station == 3 - before.station, "the order of the stations")
        step_deg = math.degrees(turn_of(after) - turn_of(before)) % 360.0
        check(abs(step_deg - 30.0 * 3 / 120.0) < 0.001, f"{step_deg} degrees between records, and not three cycles")
    other = Port(sys.argv[1], termios.B115200)
    other.send("S")
    check(other.read(1, 0.4) == b"", "it hears a host of another rate")
    right = Port(sys.argv[1], termios.B38400)
    right.send("C")
    right.read(33)
    wrong = Port(sys.argv[1], termios.B115200)
    wrong.read(33)  # what was sent before
    data = wrong.read(33 * 20)
    check(data.count(b"\r\n") < 10, "a host of another rate receives records")


if __name__ == "__main__":
    scenarios = {"orbit": orbit, "rest": rest, "cross": cross, "slow": slow}
    if len(sys.argv) != 3 or sys.argv[2] not in scenarios:
        sys.exit(__doc__)
    speed = termios.B38400 if sys.argv[2] == "slow" else termios.B115200
    scenarios[sys.argv[2]](Port(sys.argv[1], speed))
