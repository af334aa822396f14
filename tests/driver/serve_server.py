#!/usr/bin/env python3
"""A server of gloves and trackers for tests of the drivers `serve:`, independent of them: written from apps/serve/PROTOCOL.md
alone, standard library only. Prints the path of its socket, and then answers each line of input with one line:

mute, unmute    stops and starts samples and poses; requests are still answered
drop N          leaves out N samples of each device, and counts them as dropped
say TEXT        sends TEXT to all clients, as a line
heard           all requests so far, as a JSON array

Sample k of a device: its sensor number s has (7 k + s) mod 256 counts; it was measured 3 ms before it arrived, and the device's
clock is at k periods. Pose k is at (k / 1000, index, -1.5) m, turned by (0.5, -0.5, 0.5, 0.5)."""
import argparse
import json
import os
import select
import socket
import sys
import time

SENSORS = """thumb_roll thumb_mcp thumb_ip thumb_abduction index_mcp index_pip index_dip middle_mcp middle_pip middle_dip
index_middle_abduction ring_mcp ring_pip ring_dip middle_ring_abduction little_mcp little_pip little_dip ring_little_abduction
palm_arch wrist_pitch wrist_yaw""".split()
MS = 1_000_000


def glove(index, side):
    return {"class": "GLOVE", "index": index, "side": side, "source": f"serial:/dev/ttyUSB{index}", "model": "CyberGlove, 22 sensors",
            "hand": side, "sensors": SENSORS, "angles": {"thumb_roll": "measured"}, "rate_hz": 100.0,
            "counts": {"most": 255, "whole_range": False},
            "abilities": {"wrist_switch": True, "light": True, "vibration": True, "resistance": False},
            "facts": {"serial": f"A{index}", "firmware": "2.1", "a_last_one": "z"}, "kind": "device", "of_tomorrow": [{}]}


def tracker(index, side, used):
    return {"class": "TRACKER", "index": index, "side": side, "source": "fastrak:/dev/ttyUSB2", "model": "FASTRAK",
            "station": index + 3, "stations": [n + 3 for n in range(used)], "rate_hz": 120.0, "filtered": True,
            "stage_from_tracker_xyzw": [0.5, 0.5, -0.5, 0.5], "facts": {"serial": "F9"}, "kind": "device"}


class Client:
    def __init__(self, server, connection):
        self.server, self.connection = server, connection
        self.watch = {"samples": False, "hands": False, "rate_hz": 30.0}
        self.heard = b""
        self.dropped = 0
        options = server.options
        if options.odd == "silent":
            return
        if options.odd == "babble":
            self.send_bytes(b"220 mail.example.org ESMTP\r\n")
            return
        if options.odd == "refuse":
            self.send({"class": "ERROR", "message": "no place"})
            raise ConnectionError
        self.send({"class": "VERSION", "protocol": 2 if options.odd == "later" else 1, "version": "0.2.0", "name": options.name})
        for line in server.devices:
            self.send(line)

    def send_bytes(self, data):
        self.connection.sendall(data)

    def send(self, line):
        self.send_bytes(json.dumps(line).encode() + b"\n")

    def receive(self):
        data = self.connection.recv(65536)
        if not data:
            raise ConnectionError
        self.heard += data
        while b"\n" in self.heard:
            line, self.heard = self.heard.split(b"\n", 1)
            request = json.loads(line)
            self.server.heard.append(request)
            assert request.pop("class") == "WATCH", line
            self.watch.update(request)
            if self.server.options.odd not in ("silent", "babble"):
                self.send({"class": "WATCH", **self.watch})

    def advance(self, number, now_ns):
        """Sends sample `number` of each device."""
        if not self.watch["samples"] or self.server.is_mute:
            return
        if self.server.to_drop:
            self.dropped += 1
            return
        period_ns = int(1e9 / self.server.options.rate)
        for line in self.server.devices:
            times = {"sequence": number, "arrival_ns": now_ns, "measured_ns": now_ns - 3 * MS, "device_time_ns": number * period_ns}
            if line["class"] == "GLOVE":
                self.send({"class": "SAMPLE", "glove": line["index"], **times, "hand": line["hand"],
                           "switch": "on" if number % 2 else "off",
                           "raw": {name: (7 * number + at) % 256 for at, name in enumerate(SENSORS)},
                           "sampled_too_fast": False, "dropped": self.dropped})
            else:
                self.send({"class": "POSE", "tracker": line["index"], **times, "station": line["station"],
                           "position_m": [number / 1000, float(line["index"]), -1.5], "turn_xyzw": [0.5, -0.5, 0.5, 0.5],
                           "error": None, "dropped": self.dropped})
        self.dropped = 0


class Server:
    def __init__(self, options):
        self.options = options
        self.clients, self.heard = [], []
        self.is_mute, self.to_drop = False, 0
        self.devices = [glove(at, side) for at, side in enumerate(options.gloves.split())]
        sides = options.trackers.split()
        self.devices += [tracker(at, side, len(sides)) for at, side in enumerate(sides)]
        folder = os.environ["XDG_RUNTIME_DIR"] + "/nendo"
        os.makedirs(folder, 0o700, exist_ok=True)
        self.path = f"{folder}/{options.name}.sock"
        if os.path.exists(self.path):
            os.unlink(self.path)
        self.listener = socket.socket(socket.AF_UNIX)
        self.listener.bind(self.path)
        self.listener.listen()
        print(self.path, flush=True)

    def answer(self, line):
        word, _, rest = line.partition(" ")
        if word in ("mute", "unmute"):
            self.is_mute = word == "mute"
        elif word == "drop":
            self.to_drop = int(rest)
        elif word == "say":
            self.for_each(lambda client: client.send_bytes(rest.encode() + b"\n"))
        elif word == "heard":
            return json.dumps(self.heard)
        return word

    def for_each(self, act):
        for client in list(self.clients):
            try:
                act(client)
            except (ConnectionError, BrokenPipeError):
                client.connection.close()
                self.clients.remove(client)

    def accept(self):
        connection, _ = self.listener.accept()
        try:
            self.clients.append(Client(self, connection))
        except (ConnectionError, BrokenPipeError):
            connection.close()

    def serve(self):
        period = 1 / self.options.rate
        due, number = time.monotonic(), 0
        while True:
            wait = max(0.0, due - time.monotonic())
            ready, _, _ = select.select([sys.stdin, self.listener, *(client.connection for client in self.clients)], [], [], wait)
            if sys.stdin in ready:
                line = sys.stdin.readline()
                if not line:
                    return
                print(self.answer(line.rstrip("\n")), flush=True)
            if self.listener in ready:
                self.accept()
            self.for_each(lambda client: client.receive() if client.connection in ready else None)
            if time.monotonic() >= due:
                due += period
                now_ns = time.monotonic_ns() + int(self.options.ahead * 1e9)
                self.for_each(lambda client: client.advance(number, now_ns))
                self.to_drop = max(0, self.to_drop - 1)
                number += 1


parser = argparse.ArgumentParser()
parser.add_argument("--name", default="hands")
parser.add_argument("--gloves", default="right", help="their hands")
parser.add_argument("--trackers", default="", help="the hands that they move")
parser.add_argument("--rate", type=float, default=100.0)
parser.add_argument("--ahead", type=float, default=0.0, help="seconds by which the clock is ahead")
parser.add_argument("--odd", choices=["silent", "babble", "refuse", "later"])
Server(parser.parse_args()).serve()
