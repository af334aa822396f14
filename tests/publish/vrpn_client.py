#!/usr/bin/env python3
"""A client of a VRPN server, written from descriptions of VRPN's protocol, which knows nothing of Nendo's sources: their test.
vrpn_client.py PORT [--ask] [--messages N] [--ping NAME...]: connects, prints a JSON object for each message, and ends after N of
them or when the server closes. With --ask it asks by UDP to be connected to, as VRPN's own client does. Ends with 1 at the first
thing that does not fit."""
import argparse
import json
import socket
import struct
import sys
import time

COOKIE = b"vrpn: ver. 07.35  0".ljust(24, b"\0")
DESCRIBES_SENDER, DESCRIBES_TYPE = -1, -2


def message(sender, kind, payload=b""):
    head = struct.pack(">IIIiiI", 24 + len(payload), int(time.time()), 0, sender, kind, 7)
    return head + payload + bytes(-len(payload) % 8)


def name(kind, number, text):
    return message(number, kind, struct.pack(">I", len(text) + 1) + text.encode() + b"\0")


def connection_to(port, asks):
    if not asks:
        return socket.create_connection(("127.0.0.1", port))
    listener = socket.create_server(("127.0.0.1", 0))
    asking = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    listener.settimeout(1)
    for _ in range(20):
        asking.sendto(f"127.0.0.1 {listener.getsockname()[1]}".encode() + b"\0", ("127.0.0.1", port))
        try:
            return listener.accept()[0]
        except socket.timeout:
            pass
    raise AssertionError("the server does not connect")


def receive(connection, count):
    data = b""
    while len(data) < count:
        part = connection.recv(count - len(data))
        if not part:
            return None
        data += part
    return data


def content_of(kind, payload):
    if kind == "vrpn_Tracker Pos_Quat":
        assert len(payload) == 64, "length of a pose"
        sensor, _, *numbers = struct.unpack(">ii7d", payload)
        return {"sensor": sensor, "position": numbers[:3], "turn": numbers[3:]}
    if kind == "vrpn_Analog Channel":
        count = struct.unpack(">d", payload[:8])[0]
        assert count == int(count) and len(payload) == 8 + 8 * int(count), "number of channels"
        return {"channels": struct.unpack(f">{int(count)}d", payload[8:])}
    if kind == "vrpn_Button Change":
        return dict(zip(("button", "state"), struct.unpack(">ii", payload)))
    assert not payload, "payload of " + kind
    return {}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("port", type=int)
    parser.add_argument("--ask", action="store_true")
    parser.add_argument("--messages", type=int, default=0)
    parser.add_argument("--ping", action="append", default=[])
    options = parser.parse_args()
    connection = connection_to(options.port, options.ask)
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    connection.sendall(COOKIE)
    greeting = receive(connection, 24)
    assert greeting[:14] == b"vrpn: ver. 07." and greeting[16:19] == b"  0" and not any(greeting[19:]), greeting
    # Numbers of its own, and names that the server does not know.
    out = name(DESCRIBES_TYPE, 3, "vrpn_Tracker Velocity") + name(DESCRIBES_TYPE, 11, "vrpn_Base ping_message")
    for number, text in enumerate(["Unknown0", *options.ping]):
        out += name(DESCRIBES_SENDER, 40 + number, text) + message(40 + number, 11)
    connection.sendall(out)
    senders, kinds, seen = {}, {}, 0
    while not options.messages or seen < options.messages:
        head = receive(connection, 24)
        if head is None:
            break
        length, seconds, microseconds, sender, kind, _ = struct.unpack(">IIIiiI", head)
        assert 24 <= length <= 65536, "length"
        padded = receive(connection, (length - 24 + 7) // 8 * 8)
        payload = padded[:length - 24]
        assert not any(padded[length - 24:]), "padding"
        if kind in (DESCRIBES_SENDER, DESCRIBES_TYPE):
            count, = struct.unpack(">I", payload[:4])
            assert count == len(payload) - 4 and payload[-1:] == b"\0", "name"
            (senders if kind == DESCRIBES_SENDER else kinds)[sender] = payload[4:-1].decode()
            continue
        seen += 1
        line = {"sender": senders[sender], "type": kinds[kind], "time": seconds + microseconds / 1e6}
        if kinds[kind] != "vrpn_Base pong_message":
            assert abs(line["time"] - time.time()) < 60, "time"
        print(json.dumps(line | content_of(kinds[kind], payload)), flush=True)


try:
    main()
except AssertionError as error:
    print("does not fit:", error)
    sys.exit(1)
