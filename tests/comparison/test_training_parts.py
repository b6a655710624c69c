"""A method is not compared on the parts that it was tuned on, unless that is said."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import breakaway as bk
from breakaway.ask.comparison.asked import ask

Inputs = tuple[Path, list[Path]]


@pytest.fixture
def tuned(inputs: Inputs, tmp_path: Path) -> Path:
    """Give the file of a method that was tuned on parts 0 to 7 of seed 0."""
    parts = '[[tuned_on]]\npopulation = "short"\nseed = 0\nfirst = 0\nruns = 8\n'
    file = tmp_path / "tuned.toml"
    file.write_text(inputs[1][1].read_text().replace('"ramp"', '"ramp_tuned"') + parts)
    return file


def test_training_parts_are_refused_in_one_line(inputs: Inputs, tuned: Path) -> None:
    with pytest.raises(bk.StudyError) as no:
        bk.compare_methods(inputs[0], [inputs[1][1], tuned], runs=range(6, 30))
    assert str(no.value) == (
        "seed: 0 takes parts 6 to 7, which the method 'ramp_tuned' was tuned on, so its shares "
        "would be too good; give another seed (--seed 1), or allow_training_parts "
        "(--allow-training-parts)"
    )


@pytest.mark.parametrize("given", [{"seed": 1, "runs": 30}, {"runs": range(8, 30)}])
def test_unseen_parts_are_not(inputs: Inputs, tuned: Path, given: dict[str, Any]) -> None:
    assert ask(inputs[0], [tuned], **given).names == ["ramp_tuned"]


def test_a_comparison_on_training_parts_says_so_first(
    inputs: Inputs, tuned: Path, tmp_path: Path
) -> None:
    done = bk.compare_methods(
        inputs[0], [inputs[1][1], tuned], laws="lugre", runs=12, allow_training_parts=True
    )
    assert done.result[0] == (
        "CAUTION: ramp_tuned was tuned on 8 of these 12 parts, so its shares are too good; "
        "another seed has parts that it never saw"
    )
    assert not any("was tuned on" in sentence for sentence in done.result[1:])
    (tmp_path / "comparison.toml").write_text(done.asked.toml())
    assert ask(tmp_path / "comparison.toml") == done.asked


def test_what_a_tuning_wrote_is_known_to_a_comparison_and_to_another_tuning(
    inputs: Inputs, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("optuna")
    monkeypatch.setattr("breakaway.ask.tuning.writing._draw", lambda *_: None)
    rate = "controller.rate_n_per_s"
    asked: dict[str, Any] = {
        "population": bk.load_population(inputs[0]),
        "objectives": ["released_share"],
        "tune": {rate: {"low": 2000.0, "high": 4000.0}},
        "training_runs": 4,
        "test_runs": {"first": 100, "runs": 4},
    }
    ramp = bk.load_method(inputs[1][1])
    once = bk.tune(bk.Tuning(method=ramp, **asked), out=tmp_path / "one", evaluations=1).best
    assert [parts.model_dump() for parts in once.tuned_on] == [
        {"population": "short", "seed": 0, "first": 0, "runs": 4}
    ]
    with pytest.raises(bk.StudyError, match=r"^seed: 0 takes parts 0 to 3, which the method"):
        bk.compare_methods(inputs[0], [tmp_path / "one" / "best.toml"], runs=10)
    again = asked | {"seed": 5}
    twice = bk.tune(bk.Tuning(method=once, **again), out=tmp_path / "two", evaluations=1).best
    assert [parts.seed for parts in twice.tuned_on] == [0, 5]
    fewer = asked | {"training_runs": 1, "test_runs": {"first": 2, "runs": 4}}
    with pytest.raises(
        bk.StudyError, match=r"^test_runs\.first: 2 takes parts 2 to 3, which the method 'ramp_tun"
    ):
        bk.Tuning(method=once, **fewer)
