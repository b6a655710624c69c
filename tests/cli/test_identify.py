"""`breakaway identify` shows what a log tells, and writes a joint file that runs."""

import inspect
import json
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat

from breakaway.cli.identify_options import LawChoice, LogFormat, LossChoice, MotionChoice
from breakaway.measure.identification import (
    LAWS,
    NOT_IDENTIFIED,
    JointFile,
    identify_inertia_friction,
)
from breakaway.measure.identification.output_error import LOSSES
from breakaway.measure.identification.record import MOTIONS
from breakaway.measure.logs import FORMATS, read_log

Call = Callable[..., Any]


def test_shows_both_fits_and_writes_the_joint_file(
    call: Call, log_csv: Path, tmp_path: Path
) -> None:
    out = tmp_path / "joint.toml"
    shown = call("identify", log_csv, "--out", out)
    assert shown.exit_code == 0
    words = " ".join(shown.stdout.split())
    for text in ("Symmetric", "Asymmetric", "Coulomb negative", "std. error", f"wrote {out}"):
        assert text in words
    assert all(field in words for field in NOT_IDENTIFIED)
    assert re.search(r"relative force error +0\.\d\d +%", shown.stdout)
    assert JointFile.load(out).joint.coulomb_n == pytest.approx(300.0, rel=1e-3)
    assert call("run", "paper_as_computed", "--joint", out).exit_code == 0


def test_json_is_one_document(call: Call, log_csv: Path, tmp_path: Path) -> None:
    out = tmp_path / "joint.toml"
    args = ("--out", out, "--json", "--decimation", 5, "--lowpass-hz", 150)
    content = json.loads(call("identify", log_csv, *args).stdout)
    assert (content["decimation"], content["lowpass_hz"]) == (5, 150.0)
    assert content["symmetric"]["mass_kg"] == pytest.approx(3.0, rel=1e-2)
    assert content["symmetric"]["standard_error"]["mass_kg"] > 0.0
    assert content["asymmetric"]["coulomb_positive_n"] == pytest.approx(302.0, rel=1e-2)
    assert content["file"] == str(out)
    assert out.is_file()


def test_without_out_nothing_is_written(call: Call, log_csv: Path) -> None:
    assert call("identify", log_csv).exit_code == 0
    assert list(log_csv.parent.iterdir()) == [log_csv]


def test_negative_friction_is_shown_but_not_written(call: Call, tmp_path: Path) -> None:
    t_s = np.arange(5000) / 1000.0
    v = 0.3 * np.cos(5 * t_s) + 0.2 * np.cos(2 * t_s)
    force = np.gradient(3 * v, t_s) - 20 * v + 50 * np.sign(v)
    x = 0.06 * np.sin(5 * t_s) + 0.1 * np.sin(2 * t_s)
    log, out = tmp_path / "log.csv", tmp_path / "joint.toml"
    table = np.column_stack([t_s, x, force])
    np.savetxt(log, table, delimiter=",", header="t_s,x_m,force_N", comments="", fmt="%.17g")
    failed = call("identify", log, "--out", out)
    assert failed.exit_code == 2
    assert "Symmetric" in failed.stdout
    assert "viscous_n_s_per_m comes out as -" in failed.stderr
    failed = call("identify", log, "--out", out, "--json")
    assert (failed.exit_code, failed.stdout) == (2, "")
    assert not out.exists()


def test_what_the_command_line_repeats_is_what_the_api_says(call: Call) -> None:
    assert [format.value for format in LogFormat] == list(FORMATS)
    assert [law.value for law in LawChoice] == [*LAWS, "compare"]
    assert [motion.value for motion in MotionChoice] == list(MOTIONS)
    assert [loss.value for loss in LossChoice] == list(LOSSES)
    defaults = inspect.signature(identify_inertia_friction).parameters
    words = " ".join(call("identify", "--help").stdout.split())
    assert f"[default: ({defaults['decimation'].default:g})]" in words


# With a law.

QUICK = ("--law", "coulomb", "--starts", 1)


@pytest.fixture
def rig_csv(tmp_path: Path) -> Path:
    """Give 4 s of a part with 300 N of Coulomb and 400 N s/m of viscous friction, and a loop."""
    t_s = np.arange(2000) / 500.0
    v = 0.1 * np.cos(5 * t_s) + 0.13 * np.cos(13 * t_s + 1)
    x = 0.02 * np.sin(5 * t_s) + 0.01 * np.sin(13 * t_s + 1)
    noise = 2.0 * np.random.default_rng(0).standard_normal(len(v))
    force = 300.0 * np.sign(v) + 400.0 * v + 5.0 + noise
    path = tmp_path / "rig.csv"
    table = np.column_stack([t_s, x, force, x + 1e-3, 2.0 * force])
    header = "t_s,position_m,force_n,reference_m,friction_n"
    np.savetxt(path, table, "%.12g", ",", header=header, comments="")
    return path


def words_of(shown: Any) -> str:
    assert shown.exit_code == 0, shown.stderr
    return " ".join(shown.stdout.split())


def test_a_law_is_shown_with_intervals_and_what_is_left_open(
    call: Call, rig_csv: Path, tmp_path: Path
) -> None:
    out = tmp_path / "joint.toml"
    words = words_of(call("identify", rig_csv, *QUICK, "--out", out))
    for text in (
        "Coulomb, imposed motion",
        "95 % interval",
        "Not identified",
        "stiction_ratio (F_s / F_c)",
        "fit law 'stribeck' or 'lugre'",
        "RMS error of the force",
        "stiction peak: not identified",
        f"wrote {out}",
    ):
        assert text in words
    joint = JointFile.load(out)
    assert joint.joint.coulomb_n == pytest.approx(300.0, rel=0.02)
    assert joint.joint.viscous_n_s_per_m == pytest.approx(400.0, rel=0.05)
    assert joint.provenance.log_sha256 == read_log(rig_csv).sha256
    assert call("run", "paper_as_computed", "--joint", out).exit_code == 0


def test_a_law_as_json_is_one_document(call: Call, rig_csv: Path, tmp_path: Path) -> None:
    out = tmp_path / "joint.toml"
    args = (*QUICK, "--json", "--out", out, "--held-out", "3:4", "--repeat", "0:1.5")
    shown = call("identify", rig_csv, *args, "--repeat", "1.5:3", "--asymmetric")
    content = json.loads(shown.stdout)
    names = [one["name"] for one in content["estimates"]]
    assert names == [
        "coulomb_positive_n",
        "coulomb_negative_n",
        "viscous_positive_n_s_per_m",
        "viscous_negative_n_s_per_m",
        "offset_2_n",
    ]
    for one in content["estimates"]:
        assert one["low"] < one["value"] < one["high"]
    assert content["held_out_rms_error"] < 60.0
    assert (content["complete"], content["starts"], content["file"]) == (True, 1, str(out))
    assert {one["parameter"] for one in content["verdicts"]} >= set(names)
    fit = JointFile.load(out).provenance.fit
    assert fit is not None and fit.repeats == [[0.0, 1.5], [1.5, 3.0]]


def test_what_is_infinite_is_null_in_json(call: Call, rig_csv: Path) -> None:
    args = ("--law", "stribeck", "--fix", "stiction_ratio=1", "--starts", 1, "--json")
    shown = call("identify", rig_csv, *args)
    assert shown.exit_code == 0, shown.stderr
    assert "Infinity" not in shown.stdout
    assert json.loads(shown.stdout)["fixed"] == {"stiction_ratio": 1.0}


def test_laws_are_compared_on_rows_held_out(call: Call, rig_csv: Path) -> None:
    args = ("--law", "compare", "--held-out", "1:1.5", "--repeat", "0:1", "--starts", 1)
    words = words_of(call("identify", rig_csv, *args))
    for text in ("Laws compared", "pays", "held-out error", "AIC above best", "elasto-plastic"):
        assert text in words
    content = json.loads(call("identify", rig_csv, *args, "--json").stdout)
    assert [one["law"] for one in content["compared"]] == list(LAWS)
    chosen = [one["law"] for one in content["compared"] if one["pays"]][-1]
    assert content["law"] == chosen


def test_held_parameters_and_other_channels_are_asked_for(call: Call, rig_csv: Path) -> None:
    args = (*QUICK, "--fix", "mass_kg=2", "--fix", "offset_n=10", "--use", "force_n=friction_n")
    content = json.loads(call("identify", rig_csv, *args, "--json").stdout)
    assert content["fixed"] == {"mass_kg": 2.0, "offset_n": 10.0}
    assert content["estimates"][0]["value"] == pytest.approx(600.0, rel=0.05)
    words = words_of(call("identify", rig_csv, *args))
    assert "- force_n is the channel 'friction_n'" in words


def test_free_fits_what_would_be_held(call: Call, tmp_path: Path) -> None:
    t_s = np.arange(2000) / 500.0
    velocity = 0.02 * np.tanh(np.sin(2 * np.pi * t_s) / 0.06)
    force = 5.0 * np.tanh(velocity / 1e-3)
    path = tmp_path / "one_speed.csv"
    table = np.column_stack([t_s, np.cumsum(velocity) / 500.0, force])
    np.savetxt(path, table, "%.12g", ",", header="t_s,position_m,force_n", comments="")

    def fitted(*args: str) -> list[str]:
        content = json.loads(call("identify", path, *QUICK, "--json", *args).stdout)
        return [one["name"] for one in content["estimates"]]

    assert fitted() == ["coulomb_n", "offset_n"]
    assert fitted("--free", "viscous_n_s_per_m") == ["coulomb_n", "viscous_n_s_per_m", "offset_n"]


def test_a_controller_file_closes_the_loop(call: Call, rig_csv: Path, tmp_path: Path) -> None:
    path = tmp_path / "drive.toml"
    args = (*QUICK, "--motion", "closed_loop", "--controller", path, "--json")
    path.write_text(
        'kind = "cascade"\nposition_gain_per_s = 60.0\n'
        "velocity_gain_n_s_per_m = 4000.0\nforce_limit_n = 1000.0\n"
    )
    assert json.loads(call("identify", rig_csv, *args).stdout)["motion"] == "closed_loop"
    path.write_text(
        'kind = "pid"\n[gains]\nkind = "given"\n'
        "kp_n_per_m = 1e5\nki_n_per_m_s = 0.0\nkd_n_s_per_m = 100.0\n"
    )
    assert json.loads(call("identify", rig_csv, *args).stdout)["motion"] == "closed_loop"


def test_a_mapping_names_columns_and_units(call: Call, rig_csv: Path, tmp_path: Path) -> None:
    log = read_log(rig_csv)
    other, mapping = tmp_path / "other.csv", tmp_path / "columns.toml"
    table = np.column_stack([log.t_s, 1e3 * log.position_m, log.force_n])
    np.savetxt(other, table, "%.12g", ",", header="zeit,weg,kraft", comments="")
    mapping.write_text(
        'time = { from = "zeit", unit = "s" }\n'
        '[channels]\nposition_m = { from = "weg", unit = "mm" }\n'
        'force_n = { from = "kraft", unit = "N" }\n'
    )
    content = json.loads(call("identify", other, *QUICK, "--mapping", mapping, "--json").stdout)
    assert content["estimates"][0]["value"] == pytest.approx(300.0, rel=0.02)


def test_the_format_is_guessed_or_given(call: Call, rig_csv: Path, tmp_path: Path) -> None:
    log, path = read_log(rig_csv), tmp_path / "rig.mat"
    savemat(path, {"t_s": log.t_s, "position_m": log.position_m, "force_n": log.force_n})
    guessed = call("identify", path, *QUICK, "--json")
    told = call("identify", path, *QUICK, "--json", "--format", "mat")
    assert guessed.exit_code == 0
    assert guessed.stdout == told.stdout


@pytest.mark.slow
@pytest.mark.parametrize("law", [(), QUICK])
def test_a_report_is_written_beside_the_joint_file(
    call: Call, log_csv: Path, tmp_path: Path, law: tuple[Any, ...]
) -> None:
    out = tmp_path / "joint.toml"
    words = words_of(call("identify", log_csv, *law, "--out", out, "--report"))
    page = tmp_path / "joint.html"
    assert f"wrote 2 files to {tmp_path}{os.sep}: joint.toml, joint.html" in words
    text = page.read_text()
    assert text.lower().startswith("<!doctype html>")
    assert "motor.csv" in text


BAD = [
    (("--law", "dahl"), "--law"),
    (("--law", "compare"), "--law compare: needs --held-out START:END"),
    ((*QUICK, "--motion", "fast"), "--motion"),
    ((*QUICK, "--motion", "closed_loop"), "controller: motion 'closed_loop' needs a Cascade"),
    ((*QUICK, "--starts", "0"), "--starts"),
    ((*QUICK, "--seed", "-1"), "--seed"),
    ((*QUICK, "--loss", "l1"), "--loss"),
    ((*QUICK, "--repeat", "0-1"), "--repeat: '0-1' is not of the form START:END"),
    ((*QUICK, "--repeat", "a:1"), "--repeat: 'a' is not a finite number"),
    ((*QUICK, "--repeat", "1:nan"), "--repeat: 'nan' is not a finite number"),
    ((*QUICK, "--repeat", "2:1"), "the span 2 s to 1 s holds 0 rows"),
    ((*QUICK, "--held-out", "3"), "--held-out: '3' is not of the form START:END"),
    ((*QUICK, "--held-out", "30:40"), "the span 30 s to 40 s holds 0 rows"),
    ((*QUICK, "--fix", "mass_kg"), "--fix: 'mass_kg' is not of the form NAME=VALUE"),
    ((*QUICK, "--fix", "mass_kg=heavy"), "--fix: 'heavy' is not a finite number"),
    ((*QUICK, "--fix", "mass=1"), "'mass' is not a parameter of this law"),
    ((*QUICK, "--free", "mass"), "'mass' is not a parameter of this law"),
    ((*QUICK, "--use", "force_n"), "--use: 'force_n' is not of the form CHANNEL=OTHER"),
    ((*QUICK, "--use", "force_n=none_n"), "there is no channel 'none_n'"),
    ((*QUICK, "--use", "force_n=position_m"), "they must have the same dimension"),
    ((*QUICK, "--controller", "none.toml"), "none.toml: there is no such file"),
    ((*QUICK, "--controller", "drive.toml"), "kind: 'servo' is not one of 'cascade', 'pid'"),
    ((*QUICK, "--mapping", "none.toml"), "none.toml: there is no such mapping file"),
    ((*QUICK, "--format", "docx"), "--format"),
    ((*QUICK, "--lowpass-hz", "0"), "lowpass_hz is 0"),
]


@pytest.mark.slow
@pytest.mark.parametrize(("args", "words"), BAD, ids=[" ".join(map(str, a[-2:])) for a, _ in BAD])
def test_a_bad_option_is_one_line_and_writes_nothing(
    call: Call,
    rig_csv: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    args: tuple[Any, ...],
    words: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "drive.toml").write_text('kind = "servo"\n')
    before = sorted(tmp_path.iterdir())
    failed = call("identify", rig_csv, *args, "--out", "joint.toml", "--report", "--json")
    assert (failed.exit_code, failed.stdout) == (2, "")
    assert words in failed.stderr
    if failed.stderr.startswith("error: "):
        assert failed.stderr.count("\n") == 1
    assert sorted(tmp_path.iterdir()) == before


def test_a_log_is_cut_before_it_is_resampled(call: Call, tmp_path: Path) -> None:
    t_s = np.delete(np.arange(4000) / 1000.0, slice(3000, 3500))
    x, v = 0.06 * np.sin(5 * t_s), 0.3 * np.cos(5 * t_s)
    force = 3.0 * -1.5 * np.sin(5 * t_s) + 25.0 * v + 30.0 * np.sign(v)
    path = tmp_path / "gap.csv"
    rows = np.column_stack([t_s, x, force])
    np.savetxt(path, rows, delimiter=",", header="t_s,position_m,force_n", comments="")
    refused = call("identify", path, "--resample-hz", 500)
    assert refused.exit_code == 2
    assert "has a gap of 0.501 s after 2.999 s" in refused.stderr and "--between" in refused.stderr
    done = call("identify", path, "--between", 0, 2.9, "--resample-hz", 500, "--json")
    assert done.exit_code == 0, done.stderr
    assert json.loads(done.stdout)["symmetric"]["mass_kg"] == pytest.approx(3.0, rel=0.05)
    again = call("identify", path, "--drop-bad-rows", "--between", 0, 2.9, "--json")
    assert json.loads(again.stdout)["symmetric"]["mass_kg"] == pytest.approx(3.0, rel=0.05)
