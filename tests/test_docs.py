"""The code in README and docs runs, and prints what it says."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = [
    path
    for path in [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("examples/**/*.md")]
    if ".venv" not in path.parts
]
PROGRAM = Path(sys.executable).with_name("breakaway")


def blocks(page: Path, language: str) -> list[str]:
    """Fenced blocks of a language in a page."""
    return re.findall(rf"^```{language}\n(.*?)^```$", page.read_text(encoding="utf-8"), re.M | re.S)


def with_blocks(language: str) -> list[object]:
    """The pages that have such blocks."""
    return [
        pytest.param(page, id=str(page.relative_to(ROOT)))
        for page in PAGES
        if blocks(page, language)
    ]


@pytest.mark.slow
@pytest.mark.parametrize("page", with_blocks("python"))
def test_python_runs_and_prints_what_its_comments_say(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    namespace: dict[str, object] = {}
    for block in blocks(page, "python"):
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(block, str(page), "exec"), namespace)
        expected = [line[2:] for line in block.splitlines() if line.startswith("# ")]
        assert printed.getvalue().splitlines() == expected


@pytest.mark.slow
@pytest.mark.parametrize("page", with_blocks("console"))
def test_commands_run(page, tmp_path):
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    for block in blocks(page, "console"):
        for line in block.splitlines():
            program, *arguments = shlex.split(line, comments=True)
            if program != "breakaway":
                assert program == "make", f"what is {program}?"
                continue
            done = subprocess.run(
                [PROGRAM, *arguments], cwd=tmp_path, capture_output=True, text=True, check=False
            )
            assert done.returncode == 0, f"{line}\n{done.stdout}{done.stderr}"


def test_the_readme_is_covered():
    readme = ROOT / "README.md"
    assert blocks(readme, "python")
    assert sum(block.count("breakaway ") for block in blocks(readme, "console")) >= 5


def test_make_targets_that_docs_name_exist():
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = set(re.findall(r"^([a-z]+):", makefile, re.M))
    named = set()
    for page in PAGES:
        named |= set(re.findall(r"(?:`|^\s*)make ([a-z]+)\b", page.read_text("utf-8"), re.M))
    assert named >= {"demo", "test", "lint", "bench"}
    assert named <= targets


def test_links_lead_somewhere():
    for page in PAGES:
        for target in re.findall(r"\]\(([^)#]+)\)", page.read_text(encoding="utf-8")):
            if "://" not in target:
                assert (page.parent / target).exists(), f"{page.name} links to {target}"


@pytest.mark.slow
@pytest.mark.parametrize(
    "script", sorted((ROOT / "examples").glob("*/*.py")), ids=lambda script: script.stem
)
def test_examples_run(script, tmp_path):
    done = subprocess.run(
        [sys.executable, script], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip()


def test_no_placeholder_is_left():
    for page in PAGES:
        left = re.findall(r"^[A-Z]{3,}_[A-Z]{3,}$", page.read_text(encoding="utf-8"), re.M)
        assert not left, f"{page.name}: {left}"
