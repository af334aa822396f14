#!/usr/bin/env python3
"""A VRPN server for tests of the client, independent of it: written from the protocol's description alone, standard library
only. Prints `port N`, and then one line for each thing that a client says. Serves any number of clients until it is killed.

Pose number k (from 0, per connection) of sensor s of the tracker is at (k / 1000, s, -1.5) m, turned by (0.5, -0.5, 0.5, 0.5).
Poses of other senders are at 99 m."""
import argparse
import math
import random
import select
import socket
import struct
import time

DESCRIBES_SENDER, DESCRIBES_TYPE, UDP_PORT = -1, -2, -3
TYPES = ["vrpn_Base text_message", "vrpn_Base ping_message", "vrpn_Base pong_message", "vrpn_Tracker Pos_Quat",
         "vrpn_Tracker Velocity", "vrpn_Tracker Acceleration", "vrpn_Button Change"]


def cookie_of(version):
    return version.encode().ljust(16)[:16] + b"  0" + bytes(5)


def message(sender, kind, payload, stamp=None, length=None, number=0):
    stamp = time.time() if stamp is None else stamp
    head = struct.pack(">IIIiiI", 24 + len(payload) if length is None else length, int(stamp),
                       int(stamp * 1e6) % 1000000, sender, kind, number)
    return head + payload + bytes(-len(payload) % 8)


def name(kind, number, text):
    return message(number, kind, struct.pack(">I", len(text) + 1) + text.encode() + b"\0")


class Client:
    """A connection, and what has been said in it."""

    def __init__(self, server, connection):
        self.server, self.connection = server, connection
        self.heard, self.greeted, self.sent = b"", False, 0
        self.senders, self.types = {}, {}
        self.due = None  # when the next poses are due
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def send(self, data):
        if self.server.options.cut:
            while data:
                piece = random.randint(1, 40)
                self.connection.sendall(data[:piece])
                data = data[piece:]
        else:
            self.connection.sendall(data)

    def receive(self):
        data = self.connection.recv(65536)
        if not data:
            raise ConnectionError("the client has closed")
        self.heard += data
        if not self.greeted and len(self.heard) >= 24:
            self.server.say(f"cookie {self.heard[:24]!r}")
            self.heard, self.greeted = self.heard[24:], True
            self.introduce()
        while self.greeted and len(self.heard) >= 24:
            length, _, _, sender, kind, _ = struct.unpack(">IIIiiI", self.heard[:24])
            whole = (length + 7) // 8 * 8
            if len(self.heard) < whole:
                break
            self.take(sender, kind, self.heard[24:length])
            if any(self.heard[length:whole]):
                self.server.say("padding not zero")
            self.heard = self.heard[whole:]

    def take(self, sender, kind, payload):
        say = self.server.say
        if kind in (DESCRIBES_SENDER, DESCRIBES_TYPE):
            length, = struct.unpack(">I", payload[:4])
            text = payload[4:4 + length]
            if len(text) != length or text[-1:] != b"\0":
                say(f"bad name {payload!r}")
            table, word = (self.senders, "sender") if kind == DESCRIBES_SENDER else (self.types, "type")
            table[sender] = text[:-1].decode()
            say(f"{word} {sender} {table[sender]}")
            # A server makes a name that it hears its own, and describes it to all.
            if kind == DESCRIBES_SENDER and table[sender] not in self.server.numbers:
                number = self.server.add(table[sender])
                self.send(name(DESCRIBES_SENDER, number, table[sender]))
            return
        if self.types.get(kind) == "vrpn_Base ping_message":
            tracker = self.senders.get(sender)
            say(f"ping of {tracker}, {1000 * (time.monotonic() - self.server.listens):.0f} ms after listening")
            options = self.server.options
            if tracker in options.tracker and not options.no_pong:
                self.send(message(self.server.numbers[tracker], self.server.kinds["vrpn_Base pong_message"], b""))
            return
        say(f"unknown message {sender} {kind} {payload!r}")

    def introduce(self):
        server = self.server
        out = message(40001, UDP_PORT, b"127.0.0.1\0")
        if server.options.noise:
            out += server.hostile_names()
        if server.options.clash:
            out += server.clashing_names()
        for text, number in server.numbers.items():
            out += name(DESCRIBES_SENDER, number, text)
        for text, number in server.kinds.items():
            out += name(DESCRIBES_TYPE, number, text)
        self.send(out)
        self.due = time.monotonic()

    def advance(self, now):
        options = self.server.options
        if self.due is None or now < self.due or options.no_poses:
            return
        self.due += 1 / options.rate
        if options.stop_after and self.sent >= options.stop_after:
            return
        out = b""
        if options.noise:
            out += self.server.noise()
        if options.clash:
            out += self.server.pose(5000 % 1999, 0, 99.0) + self.server.pose(self.server.numbers["Tracker"], 0, 99.0)
        for tracker in options.tracker:
            for sensor in options.sensors:
                out += self.server.pose(self.server.numbers[tracker], sensor, self.sent / 1000)
        if options.text and self.sent % 5 == 0:
            payload = struct.pack(">II", 1, 0) + options.text.encode() + bytes(1024 - len(options.text))
            out += message(self.server.numbers[options.tracker[0]], self.server.kinds["vrpn_Base text_message"], payload)
        self.sent += 1
        if options.bad_length is not None and self.sent == 30:
            out += message(0, 0, b"", length=options.bad_length) + b"\xa5" * 4000
        self.send(out)


class Server:
    def __init__(self, options):
        self.options = options
        self.numbers, self.kinds = {}, {}
        for text in ["VRPN Control", "Button0"] + (["Tracker", "Tracker00"] if options.clash else []) + options.tracker:
            self.add(text)
        for text in TYPES:
            self.kinds[text] = len(self.kinds) + options.offset * 3
        family = socket.AF_INET6 if ":" in options.address else socket.AF_INET
        self.listener = socket.socket(family, socket.SOCK_STREAM)
        self.listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.listener.bind((options.address, options.port))
        self.listener.listen()
        self.listens = time.monotonic()
        self.clients = {}
        self.say(f"port {self.listener.getsockname()[1]}")

    def say(self, line):
        print(line, flush=True)

    def add(self, text):
        self.numbers[text] = len(self.numbers) + self.options.offset
        return self.numbers[text]

    def pose(self, sender, sensor, x):
        payload = struct.pack(">ii7d", sensor, 0, x, sensor if x < 90 else 99, -1.5, 0.5, -0.5, 0.5, 0.5)
        return message(sender, self.kinds["vrpn_Tracker Pos_Quat"], payload, time.time() + self.options.clock)

    def hostile_names(self):
        out = b""
        for number in (-5, 2000, 2**31 - 1, -2**31):
            out += name(DESCRIBES_SENDER, number, self.options.tracker[0])
            out += name(DESCRIBES_TYPE, number, "vrpn_Tracker Pos_Quat")
        out += message(9, DESCRIBES_SENDER, b"")
        out += message(9, DESCRIBES_SENDER, struct.pack(">I", 0xFFFFFFFF) + b"Tracker0\0")
        out += message(9, DESCRIBES_TYPE, struct.pack(">I", 0) + b"vrpn_Tracker Pos_Quat\0")
        out += message(9, DESCRIBES_SENDER, struct.pack(">I", 60001) + b"n" * 60000 + b"\0")
        for number in range(100, 1900):
            out += name(DESCRIBES_SENDER, number, "\x1b[31m" + "n" * 90)
        return out

    def clashing_names(self):
        """Names and numbers that are the tracker's in part only. The last description of a number counts."""
        tracker = self.options.tracker[0]
        return b"".join([name(DESCRIBES_TYPE, 900, tracker), name(DESCRIBES_SENDER, 901, "vrpn_Tracker Pos_Quat"),
                         name(DESCRIBES_SENDER, 5000 % 1999, tracker), name(DESCRIBES_SENDER, 5000 % 1999, "Other"),
                         name(DESCRIBES_SENDER, 902, tracker + " "), name(DESCRIBES_SENDER, 903, tracker.lower())])

    def noise(self):
        """What a client skips, and what it counts as bad."""
        tracker = self.numbers[self.options.tracker[0]]
        moves = self.kinds["vrpn_Tracker Pos_Quat"]
        choices = [
            lambda: message(tracker, self.kinds["vrpn_Tracker Velocity"], bytes(72)),
            lambda: message(tracker, random.randint(1000, 2**31 - 1), bytes(random.randint(0, 60000))),
            lambda: message(random.randint(-2**31, -1), moves, bytes(64)),
            lambda: message(tracker, -random.randint(5, 2**31), bytes(random.randint(0, 99))),
            lambda: message(self.numbers["Button0"], self.kinds["vrpn_Button Change"], bytes(8)),
            lambda: message(tracker, moves, bytes(random.choice((0, 4, 63, 65, 8000)))),
            lambda: self.pose(tracker, random.choice((-1, 7, 2**31 - 1)), 99.0),
            lambda: message(tracker, self.kinds["vrpn_Base text_message"], b"\0\0"),
        ]
        return random.choice(choices)()

    def run(self):
        while True:
            now = time.monotonic()
            due = [client.due for client in self.clients.values() if client.due is not None and not self.options.no_poses]
            wait = max(0.0, min(due) - now) if due else 0.2
            ready, _, _ = select.select([self.listener, *self.clients], [], [], wait)
            for connection in ready:
                if connection is self.listener:
                    self.accept()
                else:
                    self.serve(connection, Client.receive)
            for connection in list(self.clients):
                self.serve(connection, lambda client: client.advance(time.monotonic()))

    def accept(self):
        connection, _ = self.listener.accept()
        self.say("client")
        options = self.options
        if options.closes:
            connection.close()
            return
        self.clients[connection] = Client(self, connection)
        if options.first_words is not None:
            connection.sendall(options.first_words.encode())
        elif not options.mute:
            self.serve(connection, lambda client: client.send(cookie_of(options.version)))

    def serve(self, connection, action):
        client = self.clients.get(connection)
        if client is None or (self.options.mute and action is not Client.receive):
            return
        try:
            if self.options.mute:
                if not connection.recv(65536):
                    raise ConnectionError("the client has closed")
            else:
                action(client)
        except OSError as error:
            self.say(f"gone: {error}")
            connection.close()
            del self.clients[connection]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--address", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=0)
    parser.add_argument("--tracker", action="append", help="names of trackers")
    parser.add_argument("--no-tracker", action="store_true")
    parser.add_argument("--sensors", type=lambda text: [int(part) for part in text.split(",")], default=[0, 1])
    parser.add_argument("--rate", type=float, default=120.0, help="poses of each sensor per second")
    parser.add_argument("--clock", type=float, default=0.0, help="seconds that the server's clock is ahead")
    parser.add_argument("--offset", type=int, default=0, help="the first sender's number")
    parser.add_argument("--version", default="vrpn: ver. 07.35")
    parser.add_argument("--first-words", help="what it says instead of the cookie")
    parser.add_argument("--cut", action="store_true", help="sends pieces of up to 40 bytes")
    parser.add_argument("--mute", action="store_true", help="accepts, and says nothing")
    parser.add_argument("--closes", action="store_true", help="accepts, and closes at once")
    parser.add_argument("--no-pong", action="store_true")
    parser.add_argument("--no-poses", action="store_true")
    parser.add_argument("--stop-after", type=int, default=0, help="sends this number of poses of each sensor")
    parser.add_argument("--noise", action="store_true", help="sends hostile and unknown messages between the poses")
    parser.add_argument("--clash", action="store_true", help="has names and numbers that resemble the tracker's")
    parser.add_argument("--text", default="", help="a text message of this content")
    parser.add_argument("--bad-length", type=int, help="sends a message of this length after 30 poses")
    options = parser.parse_args()
    options.tracker = [] if options.no_tracker else options.tracker or ["Tracker0"]
    assert math.isfinite(options.rate) and options.rate > 0
    Server(options).run()


main()
