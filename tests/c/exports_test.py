#!/usr/bin/env python3
"""exports_test.py LIBRARY HEADER: the library exports what the header declares, and nothing else."""
import pathlib
import re
import subprocess
import sys

library, header = sys.argv[1:]
text = re.sub(r"/\*.*?\*/", "", pathlib.Path(header).read_text(encoding="utf-8"), flags=re.S)
declared = set(re.findall(r"\b(nendo_\w+)\(", text))
table = subprocess.run(["readelf", "-sW", "--dyn-syms", library], check=True, capture_output=True, text=True).stdout
fields = [line.split() for line in table[table.index(".dynsym"):table.index(".symtab")].splitlines()]
exported = {row[7].split("@")[0] for row in fields if len(row) == 8 and row[4] in ("GLOBAL", "WEAK") and row[6] not in ("UND", "ABS")}
assert len(declared) > 20 and declared == exported, declared ^ exported
