"""Only regular files are opened, and TOML and JSON end in an error however they are made."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import breakaway as bk
from breakaway.ask.comparison.asked import ask
from breakaway.ask.studies.files import load_study
from breakaway.ask.tuning.files import load_tuning
from breakaway.base.reading import (
    LONGEST_WORD,
    MOST_TEXT_BYTES,
    open_regular,
    parse_toml,
    read_json,
    read_text,
    table_of,
    text_of,
)
from breakaway.errors import BreakawayError, ScenarioError, StudyError
from breakaway.measure.identification import JointFile
from breakaway.measure.logs import FORMATS, read_log
from breakaway.model.scenario import save_scenario
from breakaway.model.scenario.files import load_method, load_population, load_stack

LOADERS: dict[str, Callable[[Path], Any]] = {
    "scenario": bk.load_scenario,
    "population": load_population,
    "method": load_method,
    "stack": load_stack,
    "study": load_study,
    "tuning": load_tuning,
    "joint": JointFile.load,
    "comparison": ask,
    "log": read_log,
}


@pytest.mark.parametrize("loader", LOADERS)
def test_a_loader_takes_regular_files_only(no_file: tuple[Path, str], loader: str) -> None:
    path, words = no_file
    with pytest.raises(BreakawayError, match=rf"special\.toml: .*{words}") as error:
        LOADERS[loader](path)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("format", FORMATS)
def test_a_log_of_any_format_is_a_regular_file(no_file: tuple[Path, str], format: str) -> None:
    path, words = no_file
    with pytest.raises(bk.LogError, match=words):
        read_log(path, format=format)


def test_a_mapping_is_a_regular_file(no_file: tuple[Path, str], tmp_path: Path) -> None:
    path, words = no_file
    log = tmp_path / "motor.csv"
    log.write_text("t_s,position_m,force_n\n" + "0,0,0\n" * 12)
    with pytest.raises(bk.LogError, match=words):
        read_log(log, mapping=path)


def test_a_link_to_a_regular_file_is_followed(tmp_path: Path) -> None:
    save_scenario(bk.load_scenario("paper_as_computed"), tmp_path / "mine.toml")
    (tmp_path / "link.toml").symlink_to("mine.toml")
    assert bk.load_scenario(tmp_path / "link.toml") == bk.load_scenario(tmp_path / "mine.toml")


def test_a_link_that_leads_nowhere_is_a_missing_file(tmp_path: Path) -> None:
    (tmp_path / "link.toml").symlink_to("none.toml")
    with pytest.raises(FileNotFoundError):
        open_regular(tmp_path / "link.toml")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("\n".join(f"k{k} = 1" for k in range(10**5)), "line 50001: more than 100000 keys"),
        (".".join(["a"] * 10**5) + " = 1", "line 1: a key of more than 32 parts"),
        ("[" + ".".join(["a"] * 10**5) + "]", "line 1: a key of more than 32 parts"),
        ("x = " + "[" * 10**5 + "]" * 10**5, "line 1: more than 32 nested tables or lists"),
        ("x = " + "{a = " * 10**5 + "1" + "}" * 10**5, "more than 32 nested tables or lists"),
        ("x = " + "1" * 10**6, "line 1: a number or key of more than 400 characters"),
        ("x = -0." + "1" * 10**6, "line 1: a number or key of more than 400 characters"),
        ("k" * 10**6 + " = 1", "line 1: a number or key of more than 400 characters"),
        ("x = [" + "1, " * 10**6 + "]", "line 1: more than 100000 keys, numbers and texts"),
        ('a = 1\nb = """\n' + "line\n" * 10, "line 2: a text that is not closed"),
        ("x = 1\nx = 2", "Cannot overwrite"),
    ],
    ids=lambda value: value[:12],
)
def test_toml_beyond_a_limit_is_refused(text: str, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        parse_toml(text)


def test_toml_at_a_limit_is_read() -> None:
    assert parse_toml("x = " + "1" * LONGEST_WORD) == {"x": int("1" * LONGEST_WORD)}
    assert len(parse_toml("\n".join(f"k{k} = 1" for k in range(50_000)))) == 50_000
    assert parse_toml("x = " + "[" * 32 + "]" * 32)


def test_marks_within_texts_and_comments_do_not_count() -> None:
    marks = "[{." * 1000
    text = f"a = \"{marks}\" # {marks}\nb = '{marks}'\nc = '''\n{marks}'''\n[d]\ne = 1.5"
    assert parse_toml(text)["d"] == {"e": 1.5}


def test_a_million_keys_are_too_many_bytes_and_too_many_keys(tmp_path: Path) -> None:
    path = tmp_path / "many.toml"
    path.write_text("\n".join(f"k{k} = 1" for k in range(10**6)))
    assert path.stat().st_size > MOST_TEXT_BYTES
    with pytest.raises(ScenarioError, match=r"many\.toml: cannot be read as text: has more than"):
        bk.load_scenario(path)
    with pytest.raises(ValueError, match="more than 100000 keys"):
        parse_toml(path.read_text())


def test_errors_are_of_the_class_that_is_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "x.toml"
    with pytest.raises(StudyError, match=r"x\.toml: there is no such file; check the path"):
        text_of(path, StudyError)
    path.write_bytes(b"\xff")
    with pytest.raises(StudyError, match="cannot be read as text: 'utf-8' codec"):
        text_of(path, StudyError)
    path.write_bytes(b"\xef\xbb\xbfx = 1")
    with pytest.raises(StudyError, match="starts with a byte order mark"):
        text_of(path, StudyError)
    with pytest.raises(StudyError, match="cannot be read as text: embedded null byte"):
        text_of(Path("nul\0.toml"), StudyError)
    with pytest.raises(ScenarioError, match=r"^mine: is not TOML: "):
        table_of("x = ", "mine", ScenarioError)


def test_json_and_text_have_limits(tmp_path: Path) -> None:
    path = tmp_path / "x.json"
    path.write_text("[1, 2]")
    assert read_json(path, 6) == [1, 2]
    with pytest.raises(ValueError, match="has more than 5 bytes"):
        read_text(path, 5)
    path.write_text("[" * 10**5 + "]" * 10**5)
    with pytest.raises(ValueError, match="lists are nested too deeply"):
        read_json(path, 10**6)
    path.write_text("1" * 5000)
    with pytest.raises(ValueError, match="digits"):
        read_json(path, 10**6)


def test_a_message_has_few_lines_however_much_is_wrong(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    wrong = ", ".join(["0.1"] * 500)
    path.write_text(
        f'kind = "agreement"\nscenario = "paper_as_computed"\nagreement.variants = [{wrong}]'
    )
    with pytest.raises(StudyError, match=r"and 491 more$") as error:
        load_study(path)
    assert str(error.value).count("\n") <= 21
    path.write_text(f"kind = [{wrong}]")
    with pytest.raises(StudyError, match="is not one of") as error:
        load_study(path)
    assert len(str(error.value)) < 400
