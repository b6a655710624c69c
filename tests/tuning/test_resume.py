"""Whatever ends a tuning, finished evaluations stay, and going on gives the same bytes."""

import random
import shutil
import signal
import subprocess
import sys
import time

import pytest

import breakaway as bk

from .conftest import SPEED, contents

SCRIPT = """
import sys, tomllib
import breakaway as bk
with open(sys.argv[1], "rb") as file:
    tuning = bk.Tuning.parse(tomllib.load(file))
import breakaway.ask.tuning.writing as writing
writing._draw = lambda *_: None
bk.tune(tuning, out=sys.argv[2], resume=True, threads=1, notice=lambda said: print(said))
"""
pytestmark = pytest.mark.usefixtures("no_figures")


@pytest.fixture(scope="module")
def asked(feed):
    """Give a tuning of two numbers and objectives, some of whose evaluations are not feasible."""
    return feed(
        objectives=["median_release_velocity_m_per_s", "median_time_to_release_s"],
        constraints={"p100_release_velocity_m_per_s": {"at_most": 0.04}},
        tune={
            SPEED: {"low": 0.01, "high": 0.05},
            "actuator.stiffness_n_per_m": {"low": 1e6, "high": 1e8, "log": True},
        },
        evaluations=24,
        sampler_seed=3,
    )


@pytest.fixture(scope="module")
def whole(asked, tmp_path_factory):
    """Give the folder of the tuning that nothing interrupted."""
    folder = tmp_path_factory.mktemp("tunings") / "whole"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("breakaway.ask.tuning.writing._draw", lambda *_: None)
        bk.tune(asked, out=folder, threads=2)
    return folder


def test_the_folder_says_all(asked, whole):
    done = bk.open_tuning(whole)
    assert done.finished and done.tuning == asked and len(done.evaluations) == 24
    assert repr(done) == "<tuning 'tuning', 24 evaluations, finished>"
    assert {"numpy", "optuna", "scipy"} == set(done.manifest["libraries"])
    names = {path.name for path in whole.iterdir()} - {"pieces", ".lock"}
    points = {f"pareto_{i:02d}.toml" for i in range(1, 1 + len(done.front))}
    assert names == points | {
        "digests.txt", "manifest.json", "evaluations.csv", "pareto.csv", "best.toml", "summary.json"
    }  # fmt: skip
    lines = (whole / "evaluations.csv").read_text().splitlines()
    assert len(lines) == 25
    assert {line.split(",")[1] for line in lines[1:]} == {"feasible", "infeasible"}


def test_threads_do_not_matter(asked, whole, tmp_path):
    bk.tune(asked, out=tmp_path / "out", threads=1)
    assert contents(tmp_path / "out") == contents(whole)


def test_another_sampler_seed_tries_others(asked, whole, tmp_path):
    other = bk.tune(
        asked.model_copy(update={"sampler_seed": 4}), out=tmp_path / "out", evaluations=2
    )
    ours = bk.open_tuning(whole).evaluations
    assert other.evaluations[0] == ours[0]  # the method as it is
    assert other.evaluations[1] != ours[1]


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_kill_9_loses_no_finished_trial(asked, whole, tmp_path):
    import tomli_w

    file, folder = tmp_path / "tuning.toml", tmp_path / "killed"
    file.write_text(tomli_w.dumps(asked.model_dump(exclude_none=True)))
    path = folder / "pieces" / "evaluations.jsonl"
    moments, kept = random.Random(1), []
    for target in (4, 15):
        process = subprocess.Popen(
            [sys.executable, "-c", SCRIPT, str(file), str(folder)],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
        )
        while not path.exists() or path.read_bytes().count(b"\n") < target:
            assert process.poll() is None, process.communicate()
            time.sleep(0.002)
        time.sleep(0.03 * moments.random())
        process.send_signal(signal.SIGKILL)
        process.communicate()
        kept.append(path.read_bytes())
        assert (whole / "pieces" / "evaluations.jsonl").read_bytes().startswith(kept[-1])
    assert kept == sorted(kept, key=len)
    bk.tune(asked, out=folder, resume=True)
    assert contents(folder) == contents(whole)


@pytest.mark.slow
@pytest.mark.parametrize("after", [0, 5, 24, 26])
def test_ctrl_c_keeps_finished_trials(asked, whole, tmp_path, after):
    """Among the evaluations, and among those that are scored on unseen parts."""
    folder = tmp_path / "stopped"
    seen = set()

    def stop(at):
        seen.add((at.evaluations_done, at.doing))
        if len(seen) > after:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        bk.tune(asked, out=folder, progress=stop)
    done = bk.open_tuning(folder)
    assert not done.finished
    with pytest.raises(bk.StudyError, match=r"is not finished .* go on with --resume"):
        _ = done.summary
    found = []
    bk.tune(asked, out=folder, resume=True, progress=lambda at: found.append(at))
    assert contents(folder) == contents(whole)
    assert found[-1].runs_done == found[-1].runs_max
    assert found[-1].runs_found >= 12 * min(len(done.evaluations), 24)
    assert found[-1].evaluations_done == 24
    assert set(found[-1].best) == set(asked.objectives)


def test_more_trials_may_be_asked_for(asked, whole, tmp_path):
    """As if they had been asked for at once; points of the smaller front do not stay."""
    folder = tmp_path / "more"
    bk.tune(asked, out=folder, evaluations=12)
    assert bk.open_tuning(folder).summary["evaluations"] == 12
    others = folder / "pareto_99.toml", folder / "mine.toml"  # which no tuning wrote
    for path in others:
        path.write_text("")
    bk.tune(asked, out=folder, evaluations=24, resume=True)
    for path in others:
        path.unlink()
    assert contents(folder) == contents(whole)
    with pytest.raises(
        bk.StudyError, match=r"evaluations: 12 is less than the 24 that .* holds; give"
    ):
        bk.tune(asked, out=folder, evaluations=12, resume=True)


def test_a_finished_tuning_computes_nothing(asked, whole, tmp_path, monkeypatch):
    folder = shutil.copytree(whole, tmp_path / "done")
    monkeypatch.setattr(
        "breakaway.ask.tuning.evaluation.run_trial", lambda *_, **__: pytest.fail("simulated")
    )
    bk.tune(asked, out=folder, resume=True)
    assert contents(folder) == contents(whole)


@pytest.mark.slow
@pytest.mark.parametrize(
    "damage",
    [
        lambda text: text[:-7],  # killed in the midst of a line
        lambda text: text.replace(b'"number": 8,', b'"number": 9,'),
        lambda text: text.replace(b"controller.speed", b"controller.sped", 1),
        lambda text: b"\n" + text,
        lambda text: text + b"\xff\xfe",
        lambda text: text[: len(text) // 2] + b"7" + text[len(text) // 2 + 1 :],
        lambda text: b"".join(text.splitlines(keepends=True)[1:]),
    ],
)
def test_damaged_trials_are_tried_again_and_said(asked, whole, tmp_path, damage):
    folder = shutil.copytree(whole, tmp_path / "damaged")
    path = folder / "pieces" / "evaluations.jsonl"
    path.write_bytes(damage(path.read_bytes()))
    said = []
    bk.tune(asked, out=folder, resume=True, notice=said.append)
    assert contents(folder) == contents(whole)
    assert len(said) == 1 and said[0].startswith("evaluations.jsonl: ")


def foreign(asked, tmp_path):
    """Give the first evaluations of the same tuning on other parts: same numbers, other scores."""
    folder = tmp_path / "other"
    bk.tune(asked.model_copy(update={"seed": 5}), out=folder, evaluations=2)
    return (folder / "pieces" / "evaluations.jsonl").read_bytes().splitlines(keepends=True)


@pytest.mark.slow
@pytest.mark.parametrize("line", [0, 1])
def test_a_foreign_trial_is_tried_again_and_not_read(asked, whole, tmp_path, line):
    folder = shutil.copytree(whole, tmp_path / "mixed")
    path = folder / "pieces" / "evaluations.jsonl"
    lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(b"".join([*lines[:line], foreign(asked, tmp_path)[line], *lines[line + 1 :]]))
    done = bk.open_tuning(folder)
    assert not done.finished
    for read in (lambda: done.evaluations, lambda: done.summary, lambda: done.best):
        with pytest.raises(bk.StudyError, match=r"evaluations\.jsonl: .*--resume"):
            read()
    said = []
    bk.tune(asked, out=folder, resume=True, notice=said.append)
    assert len(said) == 1 and said[0].startswith(f"evaluations.jsonl: line {line + 1} ")
    assert contents(folder) == contents(whole)


def test_an_edited_method_is_not_read(asked, whole, tmp_path):
    folder = shutil.copytree(whole, tmp_path / "edited")
    path = folder / "best.toml"
    path.write_text(path.read_text() + "# mine\n")
    done = bk.open_tuning(folder)
    with pytest.raises(bk.StudyError, match=r"best\.toml: is not the one that was written"):
        _ = done.best
    bk.tune(asked, out=folder, resume=True)
    assert contents(folder) == contents(whole)


def test_without_resume_a_tuning_is_left_alone(asked, whole):
    before = contents(whole)
    with pytest.raises(bk.StudyError, match="already holds this tuning; go on with --resume"):
        bk.tune(asked, out=whole)
    assert contents(whole) == before


def test_another_tuning_is_refused(asked, whole):
    other = asked.model_copy(update={"training_runs": 13})
    with pytest.raises(bk.StudyError, match=r"training_runs is 12 there and 13 now"):
        bk.tune(other, out=whole, resume=True)


def test_a_study_is_no_tuning(tmp_path):
    from breakaway.ask.studies import SweepStudy, run_study

    study = SweepStudy(
        scenario="paper_as_computed",
        changes={"timing.duration_s": 0.001, "disturbance.var": 0.1},
        runs=1,
    )
    run_study(study, out=tmp_path / "study")
    with pytest.raises(bk.StudyError, match="belongs to a study, not to a tuning; open it with"):
        bk.open_tuning(tmp_path / "study")


def test_a_full_disk_keeps_what_is_finished(asked, whole, tmp_path):
    """The limit on the size of files stands for the disk."""
    resource = pytest.importorskip("resource")
    folder = tmp_path / "full"
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)

    def fill(at):
        if at.evaluations_done == 4:
            size = (folder / "pieces" / "evaluations.jsonl").stat().st_size
            resource.setrlimit(resource.RLIMIT_FSIZE, (size + 40, before[1]))

    try:
        with pytest.raises(bk.OutputError, match=r"cannot be written.*; what is finished stays"):
            bk.tune(asked, out=folder, progress=fill)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, ignored)
    assert len(bk.open_tuning(folder).evaluations) == 4
    bk.tune(asked, out=folder, resume=True, notice=lambda said: pytest.fail(said))
    assert contents(folder) == contents(whole)
