#!/usr/bin/env bash
# npTDMS 1.13.0: a channel with a scale of a type that npTDMS does not know comes back unscaled.
#
# LabVIEW writes scales into TDMS files as properties (NI_Scale[0]_Scale_Type and so on). A channel
# of the raw counts 0, 1, 2, 3 with the unit N and a scale of the type "Reciprocal" is read without an
# error or a Python warning as 0, 1, 2, 3 of type int16: raw counts, with unit_string N beside them.
# Only a message of the logger "nptdms.scaling" says that the type is not supported. The same file
# with a "Linear" scale of slope 2.5 gives 0.0, 2.5, 5.0, 7.5.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check npTDMS==1.13.0
cat > "$work/read.py" <<'PY'
import logging
import sys
import warnings

import numpy as np
from nptdms import ChannelObject, TdmsFile, TdmsWriter

warnings.simplefilter("error")
told = []
logging.getLogger("nptdms").addFilter(lambda record: False)
logging.getLogger("nptdms.scaling").addFilter(lambda record: told.append(record.getMessage()))
for kind in ("Linear", "Reciprocal"):
    scale = {
        "unit_string": "N",
        "NI_Number_Of_Scales": 1,
        "NI_Scaling_Status": "unscaled",
        "NI_Scale[0]_Scale_Type": kind,
        "NI_Scale[0]_Linear_Slope": 2.5,
        "NI_Scale[0]_Linear_Y_Intercept": 0.0,
        "NI_Scale[0]_Linear_Input_Source": 0xFFFFFFFF,
    }
    with TdmsWriter(sys.argv[1]) as writer:
        writer.write_segment([ChannelObject("rig", "force", np.arange(4, dtype="i2"), scale)])
    channel = TdmsFile.read(sys.argv[1])["rig"]["force"]
    print(kind, channel[:].dtype, *channel[:], channel.properties["unit_string"])
print("logged:", *told)
PY
seen=$("$work/venv/bin/python" "$work/read.py" "$work/log.tdms")
echo "$seen"
expected="Linear float64 0.0 2.5 5.0 7.5 N
Reciprocal int16 0 1 2 3 N
logged: Unsupported scale type: Reciprocal"
[ "$seen" = "$expected" ] || { echo "changed; expected: $expected" >&2; exit 1; }
