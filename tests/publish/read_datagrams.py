#!/usr/bin/env python3
"""Receives datagrams as apps/publish/FORMAT.md describes them, and knows nothing of Nendo's sources: their test.
read_datagrams.py PORT_FILE: writes the port that it listens at to PORT_FILE, then prints a JSON object for each hand and
each whole update; ends when none has come for two seconds after the first. Ends with 1 at what does not fit."""
import json
import os
import socket
import struct
import sys

MOST = 1400


def main():
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
    sock.bind(("127.0.0.1", 0))
    with open(sys.argv[1] + ".new", "w", encoding="ascii") as file:
        file.write(str(sock.getsockname()[1]))
    os.rename(sys.argv[1] + ".new", sys.argv[1])
    sock.settimeout(60)
    updates, sessions, datagrams = {}, set(), 0
    while True:
        try:
            data = sock.recv(65536)
        except socket.timeout:
            break
        sock.settimeout(2)
        datagrams += 1
        magic, major, _, kind, side, session, number, tick, woke, part, parts, offset = struct.unpack_from(
            "<4s4B3Qq2HI", data)
        assert magic == b"NNDO" and major == 1 and len(data) <= MOST and part < parts, "header"
        sessions.add(session)
        body = data[48:]
        if kind == 1:
            assert len(body) == 744 and side < 2 and parts == 1, "hand"
            flags, _, samples = struct.unpack_from("<IIQ", body)
            tip = struct.unpack_from("<3f", body, 16 + 28 * 10)
            print(json.dumps({"kind": "hand", "side": side, "number": number, "tick": tick, "woke": woke,
                              "flags": flags, "samples": samples, "index_tip": tip}))
        elif kind == 2:
            waiting = updates.setdefault(number, {})
            waiting[offset] = body
            if len(waiting) < parts:
                continue
            whole = b"".join(waiting[at] for at in sorted(waiting))
            del updates[number]
            names = ("number", "generation", "tick", "ticks", "missed", "rest_changes", "shape_jumps")
            values = dict(zip(names, struct.unpack_from("<7Q", whole)))
            fields, fields_bytes = struct.unpack_from("<IQ", whole, 108)
            at = 120
            for _ in range(fields):
                kernel, functions = struct.unpack_from("<2I", whole, at)
                assert kernel < 4, "kernel"
                at += 104 + 56 * functions
            assert at == len(whole) and fields_bytes == at - 120 and values["number"] == number, "update"
            print(json.dumps(dict(values, kind="update", fields=fields)))
    print(json.dumps({"kind": "end", "datagrams": datagrams, "sessions": len(sessions)}))


main()
