"""Serves an emulated device on a pseudo-terminal, for the tests of drivers.

It prints the terminal's path, then answers each line of standard input with one line. `mute` and `unmute` stop and start all
output; the device answers other lines. It ends with its input. At any other rate of the line than its own, the device hears
nothing and says noise. An `odd` device that is `silent` never says anything, one that does `babble` nothing else."""
import os
import pty
import select
import sys
import termios
import time
import tty

SPEEDS = {9600: termios.B9600, 19200: termios.B19200, 38400: termios.B38400, 57600: termios.B57600,
          115200: termios.B115200}


def serve(unit, baud, odd, answer):
    """`unit` has receive(bytes), advance(seconds) and the bytearray `out`."""
    master, slave = pty.openpty()
    tty.setraw(slave)
    os.set_blocking(master, False)
    print(os.ttyname(slave), flush=True)
    mute = False
    while True:
        ready, _, _ = select.select([master, sys.stdin], [], [], 0.001)
        if sys.stdin in ready:
            line = sys.stdin.readline()
            if not line:
                return
            line = line.strip()
            if line in ("mute", "unmute"):
                mute = line == "mute"
            print(line if line in ("mute", "unmute") else answer(unit, line), flush=True)
        data = b""
        if master in ready:
            try:
                data = os.read(master, 4096)
            except OSError:
                data = b""
        is_tuned = termios.tcgetattr(slave)[5] == SPEEDS[baud]
        if odd == "babble":
            unit.out += b"x7 noise 0\r\n"
        elif odd != "silent" and is_tuned:
            unit.receive(data)
        unit.advance(time.monotonic())
        if unit.out and not mute:
            try:
                os.write(master, bytes(unit.out) if is_tuned else bytes(byte ^ 0x9A for byte in unit.out[::2]))
            except BlockingIOError:
                pass
        unit.out.clear()
