"""Who follows the guides alone gets what they promise: all of it compiles, and runs."""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor

import pytest
from tests.guides import tree
from tests.guides.applying import COMMANDS, FENCED, Step, commands, steps

GUIDES = sorted((tree.ROOT / "docs/guides").glob("*.md"))
STEPS = [step for guide in GUIDES for step in steps(guide)]


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="the extension has another name there")
def test_all_guides_are_followed_and_what_they_add_works() -> None:
    """All in one tree and one test, because it is compiled for them together."""
    files = tree.sources()
    for step in STEPS:
        step.apply(files)
    tree.lay_out(files)
    tree.build()
    tree.run("cargo fmt --all --check")
    python = sorted({step.path for step in STEPS if step.path.endswith(".py")})
    tree.run(f"ruff check {' '.join(python)}")
    tree.run(f"ruff format --check {' '.join(python)}")
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(tree.run, [command for guide in GUIDES for command in commands(guide)]))


@pytest.mark.parametrize("guide", GUIDES, ids=lambda guide: guide.stem)
def test_a_guide_can_be_followed_alone(guide) -> None:
    files = tree.sources()
    for step in steps(guide):
        step.apply(files)


@pytest.mark.parametrize("guide", GUIDES, ids=lambda guide: guide.stem)
def test_every_block_is_a_file_a_change_or_a_command(guide) -> None:
    assert steps(guide)
    assert commands(guide)
    text = guide.read_text(encoding="utf-8")
    openings = [block["opening"] for block in FENCED.finditer(text)]
    assert text.count("\n```") == 2 * len(openings)
    for step in steps(guide):
        assert f"\n`{step.path}`:\n\n```{step.language} {step.path}\n" in text, "pages hide it"
    left = [opening for opening in openings if opening not in ("python", "console", COMMANDS)]
    assert len(left) == len(steps(guide)), left


CONTENT = "use one;\nuse two;\nmod one;\n"


def test_a_change_is_made_where_its_lines_are() -> None:
    files = {"a.rs": CONTENT.encode()}
    Step("diff", "a.rs", " use two;\n+use three;\n@@\n-mod one;\n+mod two;\n").apply(files)
    assert files["a.rs"].decode() == "use one;\nuse two;\nuse three;\nmod two;\n"


@pytest.mark.parametrize(
    ("step", "says"),
    [
        (Step("diff", "a.rs", " use three;\n+use four;\n"), "0 places"),
        (Step("diff", "a.rs", " one;\n+two;\n"), "0 places"),
        (Step("diff", "b.rs", " use one;\n+use four;\n"), "not there"),
        (Step("diff", "twice.rs", " use one;\n+use four;\n"), "2 places"),
        (Step("rust", "a.rs", "mod four;\n"), "there already"),
    ],
)
def test_a_step_that_does_not_fit_is_refused(step: Step, says: str) -> None:
    files = {"a.rs": CONTENT.encode(), "twice.rs": 2 * CONTENT.encode()}
    with pytest.raises(AssertionError, match=says):
        step.apply(files)
