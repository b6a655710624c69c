#!/usr/bin/env bash
# asammdf 8.8.28: a value-range table of MDF 4 is applied to the wrong samples where they are integers.
#
# The table says: 1 to 2 is 20, 4 to 6 is 40, anything else is -7. For the raw values 0 to 9 the
# standard's rule for integers (both ends belong to a range) gives
#   -7 20 20 -7 40 40 40 -7 -7 -7
# Seen for unsigned and signed integers, without an error or a warning:
#   40 -7 20 20 -7 -7 40 40 40 40
# The table itself is read right: as floats (where the upper end does not belong to a range), the
# same file gives -7 20 -7 -7 40 40 -7 -7 -7 -7.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check asammdf==8.8.28
cat > "$work/read.py" <<'PY'
import sys

import numpy as np
from asammdf import MDF, Signal
from asammdf.blocks.conversion_utils import from_dict

ranges = {"lower_0": 1, "upper_0": 2, "phys_0": 20, "lower_1": 4, "upper_1": 6, "phys_1": 40}
for kind in ("u1", "i4", "f8"):
    raw = np.arange(10).astype(kind)
    table = from_dict(ranges | {"default": -7})
    with MDF(version="4.10") as file:
        file.append([Signal(raw, np.arange(10.0), name="level", conversion=table)])
        file.save(sys.argv[1], overwrite=True)
    with MDF(sys.argv[1]) as file:
        read = file.get("level")
    print(kind, *(f"{float(value):g}" for value in read.samples))
PY
seen=$("$work/venv/bin/python" "$work/read.py" "$work/log.mf4" 2>/dev/null)
echo "$seen"
expected="u1 40 -7 20 20 -7 -7 40 40 40 40
i4 40 -7 20 20 -7 -7 40 40 40 40
f8 -7 20 -7 -7 40 40 -7 -7 -7 -7"
[ "$seen" = "$expected" ] || { echo "changed; expected: $expected" >&2; exit 1; }
