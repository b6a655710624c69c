"""`breakaway advise` end to end: folder, JSON, and how it ends."""

from __future__ import annotations

import json
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import tomli_w

import breakaway as bk
from breakaway.ask.durable.progress import Progress

pytestmark = pytest.mark.slow

Call = Callable[..., Any]


@pytest.fixture
def parts(tmp_path: Path) -> Path:
    """Give parts on short guides, as a population file."""
    seized = bk.load_population("seized_parts")
    guides = {"engagement_length_m": bk.Uniform(low=0.002, high=0.004)}
    short = seized.model_copy(
        update={"duration_s": 0.8, "parts": seized.parts.model_copy(update=guides)}
    )
    path = tmp_path / "parts.toml"
    path.write_text(tomli_w.dumps(short.model_dump(mode="json", exclude_none=True)))
    return path


@pytest.fixture
def limits(tmp_path: Path) -> Path:
    path = tmp_path / "limits.toml"
    path.write_text(
        'jump_max_m = 2.5e-4\n[[stresses]]\nplace = "neck"\nsection_m2 = 1e-5\nallowed_pa = 2e8\n'
    )
    return path


def test_the_command_that_the_report_shows_repeats_the_advice(
    call: Call, parts: Path, limits: Path, tmp_path: Path
) -> None:
    length = ("--engagement-length-m", 0.003)
    asked = ("advise", parts, "--rig", "screw_jack", "--limits", limits, "--parts-max", 16, *length)
    done = call(*asked, "--out", tmp_path / "a", "--json")
    assert done.exit_code == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["parts"]["judged"] == 16
    page = (tmp_path / "a" / "index.html").read_text()
    command = page[page.index("<pre>") + 5 : page.index("</pre>")].replace("&#39;", "'")
    again = call(*shlex.split(command)[1:], "--out", tmp_path / "b", "--json")
    assert again.exit_code == 0, again.stderr
    ours = {"files"}
    first, second = told, json.loads(again.stdout)
    assert {k: v for k, v in first.items() if k not in ours} == {
        k: v for k, v in second.items() if k not in ours
    }
    for name in ("method.toml", "spared.png", "course.png"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def test_the_recommended_method_can_be_compared(call: Call, parts: Path, tmp_path: Path) -> None:
    out = tmp_path / "a"
    assert (
        call("advise", parts, "--rig", "screw_jack", "--parts-max", 16, "--out", out).exit_code == 0
    )
    asked = ("--method", out / "method.toml", "--laws", "lugre", "--runs", 4)
    done = call("compare", parts, *asked, "--out", tmp_path / "c")
    assert done.exit_code == 0, done.stderr


def test_nothing_is_written_where_something_is_wrong(call: Call, tmp_path: Path) -> None:
    for wrong, words in (
        (("advise", "seized_parts", "--rig", "no_rig"), "no_rig"),
        (("advise", "no.toml"), "no.toml"),
        (("advise", "seized_parts", "--budget-s", "-1"), "budget_s"),
        (("advise", "seized_parts", "--limits", tmp_path / "no.toml"), "no.toml"),
    ):
        done = call(*wrong, "--out", tmp_path / "out")
        assert done.exit_code == 2 and words in done.stderr
        assert done.stderr.count("\n") == 1 and "Traceback" not in done.stderr
        assert not (tmp_path / "out").exists()


def test_an_interrupt_gives_the_best_so_far(parts: Path) -> None:
    """The second round is cut off: what the first one showed stands."""
    seen: list[str] = []

    def progress(at: Progress) -> None:
        if not seen or seen[-1] != at.doing:
            seen.append(at.doing)
        if seen.count("steady_feed, lugre") == 2:
            raise KeyboardInterrupt

    found = bk.advise(parts, "screw_jack", budget_s=1e6, parts_max=64, progress=progress)
    whole = bk.advise(parts, "screw_jack", budget_s=1e6, parts_max=16)
    assert found.tried.ended == "interrupted" and found.tried.parts == 16
    assert found.ranking == whole.ranking
    assert any("it was interrupted" in line for line in found.rests_on)

    def at_once(_: Progress) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        bk.advise(parts, "screw_jack", budget_s=1e6, parts_max=64, progress=at_once)
