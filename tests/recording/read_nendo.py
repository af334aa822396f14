#!/usr/bin/env python3
"""Reads a recording as apps/recording/FORMAT.md describes it, and knows nothing of Nendo's sources: their test.
Prints a JSON object for each chunk and for each entry of a tape. Ends with 1 at the first thing that does not fit."""
import json
import struct
import sys


def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc >> 1) ^ (0x82F63B78 if crc & 1 else 0)
    return crc ^ 0xFFFFFFFF


class Bytes:
    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, form):
        values = struct.unpack_from("<" + form, self.data, self.at)
        self.at += struct.calcsize("<" + form)
        return values[0] if len(values) == 1 else list(values)

    def text(self):
        size = self.take("H")
        self.at += size
        return self.data[self.at - size:self.at].decode()

    def left(self):
        return len(self.data) - self.at


def sample(b):
    s = dict(zip(("glove", "arrival", "measured", "device_time", "sequence", "present", "flags"), b.take("BqqqQIB")))
    s["raw"] = b.take("24H")
    return s


def calibration(b):
    return {"lines": b.take("48d"), "couplings": b.take("8d"), "middle_bias": b.take("d")}


def glove(b):
    g = {"number": b.take("B"), "side": b.take("B"), "source": b.text(), "model": b.text()}
    g.update(zip(("sensors", "rate_hz", "most", "whole_range", "abilities", "facts"), b.take("IdHBBH")))
    g["facts"] = [[b.text(), b.text()] for _ in range(g["facts"])]
    return g


def hand(b):
    h = {"side": b.take("B"), "size": b.take("dd"), "first": sample(b), "gated": b.take("B"), "filter": b.take("Bddd"),
         "adapt": b.take("BHB")}
    has_ends = h["filter"][0] & 64
    h["own"], h["swapped"], h["swapped_size"] = calibration(b), calibration(b), b.take("dd")
    if b.take("B"):
        h["learned"] = {"side": b.take("B"), "sensors": [b.take("ddIIdd") for _ in range(24)]}
    if b.take("B"):
        h["layer"] = dict(zip(("joints", "on", "part"), b.take("IBd")))
        if b.take("B"):
            h["layer"]["below"] = b.take("23d")
    if b.take("B"):
        h["shape"], h["swapped_shape"] = b.take("26d"), b.take("26d")
        for _ in range(2):
            later = b.take("2d"), b.take("2d")
            h["shape"], h["swapped_shape"] = h["shape"] + later[0], h["swapped_shape"] + later[1]
    if has_ends:
        h["ends"] = {"side": b.take("B"), "sensors": b.take("I"), "counts": [b.take("dd") for _ in range(24)]}
    if b.left() > 0:
        h["stuck"] = dict(zip(("watched", "most", "whole_range", "found", "left", "right"), b.take("BHBIII")))
    return h


def loop(b):
    o = {"mesh": b.text(), "vertices": b.take("Q"), "crc": b.take("I"), "units_per_metre": b.take("d"),
         "poses": [b.take("12d"), b.take("12d")]}
    o.update(zip(("rate_hz", "policy", "catch_up", "silent_ns", "switch", "mode", "piece"), b.take("dBIqBBd")))
    o["shared"] = [b.take("dd") for _ in range(b.take("H"))]
    o["own"] = [b.take("Idd") for _ in range(b.take("H"))]
    o.update(zip(("kernel", "polynomial", "merge", "order", "storage", "weight_bytes", "undo_bytes", "injective",
                  "most_bound", "most_links", "least_gap"), b.take("BBdBBQQBdId")))
    o["simd"] = b.text()
    o["undo_max_bytes"] = b.take("Q")
    o["held"] = b.take("B")
    if b.take("B"):
        o["settings"] = settings(b)
    o["subdivisions"] = b.take("I")
    o["pull_is_step"] = b.take("B")
    o.update(brushes(b))
    o.update(hold(b))
    if "settings" in o:
        o["settings"].update(hold(b))
    if b.take("B"):
        o["table"] = b.take("4d")
    rules = b.take("B")
    assert rules in (3, 7), "rules"
    o["type2_along_surface"], o["clay_scales_few_vertices"], o["tracked"] = rules & 1, rules >> 1 & 1, rules >> 2
    return o


def tracker(b):
    t = {"side": b.take("B"), "station": b.take("H"), "source": b.text(), "model": b.text(), "rate_hz": b.take("d"),
         "turn": b.take("4d"), "is_filtered": b.take("B")}
    t["facts"] = [[b.text(), b.text()] for _ in range(b.take("H"))]
    t.update(zip(("mount_turn", "mount_pose"), (b.take("4d"), b.take("12d"))))
    t.update(zip(("on_hand", "late_s", "max_distance_m", "filter"), (b.take("B"), b.take("d"), b.take("d"), b.take("B4d"))))
    t.update(zip(("scale", "lost_ns"), b.take("dq")))
    return t


def pose(b):
    p = dict(zip(("side", "arrival", "measured", "device_time", "sequence", "station"), b.take("BqqqQH")))
    p.update({"position": b.take("3d"), "turn": b.take("4d")})
    p.update(zip(("error", "has_clock"), b.take("BB")))
    return p


def rest(b):
    blocks = []
    while b.left():
        blocks.append({axis: b.take("64f") for axis in "xyz"})
    return {"blocks": blocks}


def settings(b):
    s = dict(zip(("mode", "kernel", "injective", "filter"), b.take("4B")))
    s.update({"radii": b.take("5d"), "piece": b.take("d"), "cutoffs": b.take("3d")})
    return s


def brushes(b):
    return {"brushes": b.take("5B"), "strength": b.take("d")}


def hold(b):
    return {"keep_volume": b.take("d"), "hold": b.take("B")}


def head(b):
    return {"wall": b.take("q"), "host": b.take("q"), "program": b.text(), "wearer": b.text()}


def end(b):
    return dict(zip(("host", "samples", "requests", "ticks", "lost", "has_shape", "vertices", "crc"),
                    b.take("qQQQQBQI")))


def sent(b):
    lines = {"gloves": [dict(zip(("delivered", "missed", "refused", "bad"), b.take("4Q"))) for _ in range(b.take("B"))]}
    if b.left() > 0:
        lines["known"] = [dict(zip(("missed", "clamped"), b.take("BQ"))) for _ in lines["gloves"]]
    return lines


def tape(b):
    forms = {1: sample, 2: lambda e: {"request": e.take("B")}, 5: lambda e: {"side": e.take("B"), "wrist": e.take("7d")}, 4: lambda e: {"gap": e.take("Q")},
             6: lambda e: {**settings(e), **brushes(e), **hold(e)}, 9: lambda e: {"mark": 1}, 10: lambda e: {"clutch": e.take("3B")}, 11: lambda e: {"role": e.take("HBB")},
             12: lambda e: {"symmetry": e.take("B")}, 13: lambda e: {"puppet": e.take("I")}, 15: lambda e: dict(zip(("input", "on"), e.take("BB"))), 7: lambda e: {"still": 1}, 8: lambda e: dict(zip(("model", "source", "max_vertices", "seam", "part"), e.take("IBIdI"))), 16: lambda e: {"wire": e.take("B")}, 17: pose, 18: lambda e: {"recentre": 1}, 3: lambda e: dict(zip(("tick", "scheduled", "woke"), e.take("Qqq")))}
    entries = []
    while b.left():
        kind, size = b.take("BB")
        body = Bytes(b.data[b.at:b.at + size])
        assert len(body.data) == size, "an entry ends early"
        b.at += size
        entries.append(dict(kind=kind, **forms[kind](body)))
        assert body.left() == 0, "an entry is too long"
    return entries


def points(b):
    return [b.take("3d") for _ in range(b.take("H"))]


def puppet(b):
    o = {"text": b.take(f"{b.take('I')}s").decode()}
    o["functions"] = [dict(zip(("asked", "side", "signal", "held"), b.take("dBBB"))) for _ in range(b.take("H"))]
    return dict(o, symmetric=b.take("B"), points=points(b))


def origin(b):
    source, goes_on = b.take("BB")
    assert source in (1, 2, 3, 4, 5, 6, 7), "a source of a model"
    of_shape = source > 2
    o = {"source": source, "goes_on": goes_on}
    if of_shape and not goes_on:
        o["seam"] = b.take("d")
        o["part"] = b.take("I")
        o["wire"] = [b.take("6d") for _ in range(b.take("I"))]
    o["vertices" if of_shape else "operations"] = rest = []
    while b.left() > 0:
        rest.append(b.take("3d" if of_shape else "BII"))
    return o


def puppet_version(b):
    o = {"number": b.take("I"), "text": b.take(f"{b.take('I')}s").decode()}
    return dict(o, points=points(b))


def shape(b):
    o = {"tick": b.take("Q"), "vertices": b.take("I")}
    o["xyz"] = b.take(f"{3 * o['vertices']}f")
    return o


def main():
    data = open(sys.argv[1], "rb").read()
    assert data[:8] == b"\x89NENDO\r\n" and struct.unpack_from("<HHI", data, 8) == (1, 14, crc32c(data[:12])), "header"
    at = 16
    number = 0
    readers = {"HEAD": head, "GLOV": glove, "HAND": hand, "TRAK": tracker, "LOOP": loop, "ORIG": origin, "REST": rest, "PUPP": puppet, "PUPV": puppet_version, "TAPE": tape, "SHAP": shape, "SENT": sent, "END ": end}
    while at < len(data):
        magic, kind, size, found, check = struct.unpack_from("<4s4sIII", data, at)
        assert magic == b"NCHK" and check == crc32c(data[at:at + 16]) and found == number, f"chunk header at {at}"
        payload = data[at + 20:at + 20 + size]
        assert struct.unpack_from("<I", data, at + 20 + size)[0] == crc32c(payload), f"payload at {at}"
        b = Bytes(payload)
        lines = readers[kind.decode()](b)
        assert b.left() == 0, f"{kind} at {at} has {b.left()} bytes too many"
        for line in lines if isinstance(lines, list) else [lines]:
            print(json.dumps(dict(chunk=kind.decode(), **line)))
        at += 24 + size
        number += 1


main()
