"""The report on a page and on paper: the same words, nothing run, nothing half."""

from __future__ import annotations

import hashlib
import json
import tomllib
from html.parser import HTMLParser
from pathlib import Path

import pytest

import breakaway as bk
from breakaway.errors import OutputError

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def folder(advice: bk.Advice, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("advice") / "out"
    bk.write_advice(advice, out, command="breakaway advise x", made_of=("x.toml: SHA-256 00",))
    return out


class _Text(HTMLParser):
    """The text of a page, and what it would load."""

    def __init__(self) -> None:
        super().__init__()
        self.words: list[str] = []
        self.loads: list[str] = []

    def handle_data(self, data: str) -> None:
        self.words.append(data)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag in ("script", "link", "iframe", "img"):
            self.loads.append(tag)
        self.loads += [
            value
            for name, value in attrs
            if value and name in ("src", "href", "xlink:href") and not value.startswith("#")
        ]


def _page(path: Path) -> _Text:
    parser = _Text()
    parser.feed(path.read_text(encoding="utf-8"))
    return parser


def test_the_folder_holds_report_method_and_numbers(folder: Path, advice: bk.Advice) -> None:
    names = {path.name for path in folder.iterdir()}
    assert names >= {"index.html", "report.pdf", "advice.json", "method.toml", "spared.png"}
    kept = json.loads((folder / "advice.json").read_text())
    assert kept["sentences"] == list(advice.sentences)
    assert kept["ranking"][0]["unharmed"] == advice.best.unharmed
    assert bk.load_method(folder / "method.toml") == advice.method
    assert tomllib.loads((folder / "method.toml").read_text())["name"] == advice.best.way


def test_the_page_says_what_the_advice_says_and_loads_nothing(
    folder: Path, advice: bk.Advice
) -> None:
    page = _page(folder / "index.html")
    text = " ".join(" ".join(page.words).split())
    for sentence in (*advice.sentences, *advice.rests_on):
        assert " ".join(sentence.split()) in text
    assert page.loads == []
    assert "breakaway advise x" in text and "x.toml: SHA-256 00" in text
    for way in advice.not_judged:
        assert way.name in text


def test_the_paper_is_the_same_bytes_each_time(
    folder: Path, advice: bk.Advice, tmp_path: Path
) -> None:
    bk.write_advice(
        advice, tmp_path / "a", command="breakaway advise x", made_of=("x.toml: SHA-256 00",)
    )
    first, again = (
        hashlib.sha256((one / "report.pdf").read_bytes()).hexdigest()
        for one in (folder, tmp_path / "a")
    )
    assert first == again
    assert (folder / "report.pdf").read_bytes().startswith(b"%PDF-")


def test_text_of_others_is_text(population: bk.PartPopulation, tmp_path: Path) -> None:
    """Names with markup of either format stand there as they are."""
    odd = '<b>x</b> #image("none") *y* $z$'
    rig = bk.load_rig("screw_jack").model_copy(update={"name": odd, "description": odd})
    found = bk.advise(population.model_copy(update={"name": odd}), rig, parts_max=16, budget_s=1e6)
    bk.write_advice(found, tmp_path / "out", command=odd)
    raw = (tmp_path / "out" / "index.html").read_text()
    assert "<b>x</b>" not in raw and "&lt;b&gt;x&lt;/b&gt;" in raw
    assert (tmp_path / "out" / "report.pdf").stat().st_size > 10_000


def test_a_folder_of_something_else_is_left_alone(advice: bk.Advice, tmp_path: Path) -> None:
    (tmp_path / "advice.json").write_text("{}")
    with pytest.raises(OutputError, match=r"advice\.json"):
        bk.write_advice(advice, tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"advice.json"}
