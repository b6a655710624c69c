#!/usr/bin/env bash
# npTDMS 1.13.0: of a recording that was appended to a TDMS file, only the last start and unit are told.
#
# LabVIEW appends to a TDMS file segment by segment, and each segment may give a channel another
# wf_start_time or unit_string. A channel is recorded for 0.04 s, in N from 08:00:00, and again in kN
# from 08:01:00. npTDMS joins both: eight values of one channel, whose properties are those of the
# second recording. time_track(absolute_time=True) puts the first recording at 08:01:00 too and has no
# gap, and nothing says that the first four values are in another unit. No public call of npTDMS gives
# the properties of a segment; they stand in the file.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check npTDMS==1.13.0
cat > "$work/read.py" <<'PY'
import sys

import numpy as np
from nptdms import ChannelObject, TdmsFile, TdmsWriter

path = sys.argv[1]
for mode, start, unit in (("w", "2026-11-30T08:00:00", "N"), ("a", "2026-11-30T08:01:00", "kN")):
    told = {
        "wf_start_time": np.datetime64(start, "us"),
        "wf_start_offset": 0.0,
        "wf_increment": 0.01,
        "unit_string": unit,
    }
    with TdmsWriter(path, mode=mode) as writer:
        writer.write_segment([ChannelObject("rig", "force", np.arange(4.0), told)])
channel = TdmsFile.read(path)["rig"]["force"]
stamps = channel.time_track(absolute_time=True, accuracy="ms")
print(*channel[:], channel.properties["unit_string"])
print(stamps[0], "to", stamps[-1], "steps", *sorted(set(np.diff(stamps).astype(int).tolist())))
PY
seen=$("$work/venv/bin/python" "$work/read.py" "$work/log.tdms")
echo "$seen"
expected="0.0 1.0 2.0 3.0 0.0 1.0 2.0 3.0 kN
2026-11-30T08:01:00.000000 to 2026-11-30T08:01:00.070000 steps 10000"
[ "$seen" = "$expected" ] || { echo "changed; expected: $expected" >&2; exit 1; }
