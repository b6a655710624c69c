#!/usr/bin/env bash
# asammdf 8.8.28: what a power in an MDF 4 formula gives depends on the type of the raw samples.
#
# A channel of 6, 7, 8 with the algebraic conversion "X1*10^2" and the unit N should be
# 600, 700, 800 N. Seen, without an error or a warning:
#
#   raw samples     sympy absent     sympy 1.14.0 present
#   integers        62, 68, 82       62, 68, 82            ^ is taken as exclusive or: 60 xor 2
#   floats           6,  7,  8       600, 700, 800         raw values, with the unit on them
#   floats, pow()    6,  7,  8        36,  49,  64         the same for "pow(X1,2)"
#
# The evaluator (numexpr) knows no power by ^ and no pow(); for floats it raises, asammdf then
# tries sympy, and where that is absent it gives the raw samples as if they were converted.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check asammdf==8.8.28 numexpr==2.14.2
cat > "$work/read.py" <<'PY'
import sys

import numpy as np
from asammdf import MDF, Signal
from asammdf.blocks.conversion_utils import from_dict

for kind, formula in (("u2", "X1*10^2"), ("f8", "X1*10^2"), ("f8", "pow(X1,2)")):
    raw = np.array([6, 7, 8], kind)
    signal = Signal(raw, np.arange(3.0), name="force", unit="N", conversion=from_dict({"formula": formula}))
    with MDF(version="4.10") as file:
        file.append([signal])
        file.save(sys.argv[1], overwrite=True)
    with MDF(sys.argv[1]) as file:
        read = file.get("force")
    print(kind, formula, *(f"{float(value):g}" for value in read.samples), read.unit)
PY
check() {
    seen=$("$work/venv/bin/python" "$work/read.py" "$work/log.mf4" 2>/dev/null)
    echo "$1:" && echo "$seen"
    [ "$seen" = "$2" ] || { echo "changed; expected: $2" >&2; exit 1; }
}
check "sympy absent" "u2 X1*10^2 62 68 82 N
f8 X1*10^2 6 7 8 N
f8 pow(X1,2) 6 7 8 N"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check sympy==1.14.0
check "sympy present" "u2 X1*10^2 62 68 82 N
f8 X1*10^2 600 700 800 N
f8 pow(X1,2) 36 49 64 N"
