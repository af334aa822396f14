#!/usr/bin/env python3
"""Receives OSC as its specification 1.0 and apps/publish/OSC.md describe it, and knows nothing of Nendo's sources: their test.
read_osc.py PORT_FILE: writes the port that it listens at to PORT_FILE, then prints a JSON object for each message; ends when
none has come for two seconds after the first. Ends with 1 at the first thing that does not fit."""
import json
import os
import socket
import struct
import sys


def text_at(data, at):
    end = data.index(b"\0", at)
    following = (end // 4 + 1) * 4
    assert not any(data[end:following]) and following <= len(data), "padding"
    return data[at:end].decode("ascii"), following


def message_in(data):
    address, at = text_at(data, 0)
    types, at = text_at(data, at)
    assert address.startswith("/") and types.startswith(","), "message"
    arguments = []
    for kind in types[1:]:
        assert kind in "ifs", "type " + kind
        if kind == "s":
            argument, at = text_at(data, at)
        else:
            argument = struct.unpack_from(">" + kind, data, at)[0]
            at += 4
        arguments.append(argument)
    assert at == len(data), "length"
    return {"address": address, "types": types[1:], "arguments": arguments}


def main():
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
    sock.bind(("127.0.0.1", 0))
    with open(sys.argv[1] + ".new", "w", encoding="ascii") as file:
        file.write(str(sock.getsockname()[1]))
    os.rename(sys.argv[1] + ".new", sys.argv[1])
    sock.settimeout(60)
    while True:
        try:
            data = sock.recv(65536)
        except socket.timeout:
            break
        sock.settimeout(2)
        assert len(data) <= 1200 and data[:16] == b"#bundle\0" + struct.pack(">Q", 1), "bundle"
        at = 16
        while at < len(data):
            length = struct.unpack_from(">I", data, at)[0]
            assert length % 4 == 0 and at + 4 + length <= len(data), "element"
            print(json.dumps(message_in(data[at + 4:at + 4 + length])))
            at += 4 + length


main()
