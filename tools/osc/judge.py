#!/usr/bin/env python3
"""Compares what two programs read of one stream of OSC, for tools/check-osc: judge.py FORMAT SUMMARY LIBLO NPM.
LIBLO is the output of `oscdump -L`, NPM that of receive.cjs, SUMMARY that of `nendo serve --json`."""
import json
import shlex
import sys

TYPES = {"osc": {"i", "f", "fff", 7 * "f", 23 * "f"}, "vmc": {"i", "f", "s" + 7 * "f"}}


def argument(kind, text):
    return text if kind == "s" else round(float(text), 6)


def of_liblo(path):
    for line in open(path, encoding="utf-8"):
        _, address, types, *values = shlex.split(line)
        yield address, types, tuple(argument(kind, text) for kind, text in zip(types, values, strict=True))


def of_npm(path):
    for line in open(path, encoding="utf-8"):
        address, types, values = json.loads(line)
        yield address, types, tuple(argument(kind, text) for kind, text in zip(types, values, strict=True))


def main():
    kind, summary_path, liblo_path, npm_path = sys.argv[1:]
    liblo, npm = list(of_liblo(liblo_path)), list(of_npm(npm_path))
    with open(summary_path, encoding="utf-8") as file:
        published = json.loads(file.readlines()[-1])["published"]
    sent = published[0]["datagrams"]
    assert sent == published[1]["datagrams"] and sent >= 5000, f"only {sent} datagrams"
    assert published[0]["refused_datagrams"] == published[1]["refused_datagrams"] == 0, "refused"
    assert {types for _, types, _ in liblo} <= TYPES[kind], "types"
    # UDP may lose on a busy machine; what arrives at both must be the same, in the same order.
    assert len(npm) == len(liblo), f"oscdump read {len(liblo)} messages, npm's osc {len(npm)}"
    differing = [at for at, (one, other) in enumerate(zip(liblo, npm))
                 if one[:2] != other[:2] or any(
                     a != b and (isinstance(a, str) or abs(a - b) > 2e-6) for a, b in zip(one[2], other[2]))]
    assert not differing, f"message {differing[0]}: {liblo[differing[0]]} and {npm[differing[0]]}"
    print(f"{kind}: {sent} datagrams, {len(liblo)} messages, decoded alike by oscdump and npm's osc")


main()
