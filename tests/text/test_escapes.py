"""Each escape holds for any text: its target reads the text back, or nothing that it obeys."""

import csv
import io
import re
import tomllib
import unicodedata
import warnings
from html.parser import HTMLParser
from xml.etree import ElementTree

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from markdown_it import MarkdownIt
from matplotlib.figure import Figure

from breakaway.base import text
from breakaway.drawing.style import house_style

MARKS = [
    *("*/", "/*", "//", "??", "??/", "[", "]", "(", ")", "{", "}", "é", "摩", "1", "a", " "),
    *"\\@'\"<>&`|_$#-+=.;:!~^%\n\r\t\x00\x1b\x7f\x9b\u202e\u2066\u2028\ufeff\ufffe\ud800",
]
"""What some target obeys, or what breaks it."""
TEXTS = st.one_of(st.text(max_size=40), st.lists(st.sampled_from(MARKS)).map("".join))
READABLE = "Größe 20 µm, 摩擦 (seat) no. 1: paper_as_computed"


@pytest.mark.slow
@given(TEXTS)
def test_what_is_visible_is_one_line_without_hidden_characters(given: str) -> None:
    shown = text.visible(given)
    kinds = {unicodedata.category(c) for c in shown}
    assert not kinds & {"Cc", "Cs", "Zl", "Zp"}
    assert not {unicodedata.bidirectional(c) for c in shown} & {
        *("LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI")
    }
    assert text.visible(shown) == shown
    assert len(text.visible_lines(given).split("\n")) == len(given.split("\n"))


def test_what_everyone_can_read_stays() -> None:
    joined = "\N{WOMAN}\N{ZERO WIDTH JOINER}\N{WRENCH} نمی\N{ZERO WIDTH NON-JOINER}دانم"
    for kept in (READABLE, joined):
        assert text.visible(kept) == kept


@given(TEXTS)
def test_a_terminal_is_given_no_escape_sequence(given: str) -> None:
    assert not re.search("[\x00-\x09\x0b-\x1f\x7f-\x9f]", text.terminal(given))


def test_lines_and_values_end() -> None:
    assert len(text.terminal("x" * 10**6)) < 2100
    assert len(text.shown("\x1b" * 10**6)) < 400
    assert len(text.shown(list(range(10**5)))) < 120
    assert len(text.brief("x" * 10**6)) < 120
    assert text.shown("\u202e") == r"'\u202e'"


@given(TEXTS)
@example("*\\\n/ int marker;")
def test_a_comment_of_c_stays_one(given: str) -> None:
    inside = text.c_comment(given)
    assert inside.isascii() and inside.isprintable()
    assert not re.search(r"\*/|/\*|\?\?|[@]", inside)
    assert not inside.endswith("\\")


@given(TEXTS)
def test_an_identifier_has_what_c_allows(given: str) -> None:
    assert re.fullmatch("[A-Za-z0-9_]{0,100}", text.c_identifier(given))


@given(TEXTS)
def test_xml_reads_the_text_back(given: str) -> None:
    content = text.xml(given)
    read = ElementTree.fromstring(f'<a b="{content}">{content}</a>')
    assert (read.get("b"), read.text or "") == (text.visible(given), text.visible(given))


@given(TEXTS)
def test_html_reads_the_text_back(given: str) -> None:
    class Page(HTMLParser):
        seen = ""

        def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
            raise AssertionError(tag)

        def handle_data(self, data: str) -> None:
            self.seen += data

    page = Page(convert_charrefs=True)
    page.feed(text.xml(given))
    page.close()
    assert page.seen == text.visible(given)


@given(TEXTS)
@example("1. one")
@example("- one")
@example("www.example.org")
def test_markdown_shows_the_text(given: str) -> None:
    told = " ".join(text.visible(given).split())
    parser = MarkdownIt("commonmark").enable("table")
    for page in (f"x {text.markdown(told)} x", f"| a |\n|---|\n| {text.markdown(told)} x |"):
        tokens = [t for token in parser.parse(page) for t in token.children or []]
        assert {token.type for token in tokens} <= {"text", "text_special"}
        assert f"{told} x".strip() in "".join(token.content for token in tokens)


@given(TEXTS)
def test_markdown_at_the_begin_of_a_line_is_a_paragraph(given: str) -> None:
    told = " ".join(text.visible(given).split())
    kinds = {token.type for token in MarkdownIt("commonmark").parse(text.markdown(told))}
    assert kinds <= {"paragraph_open", "inline", "paragraph_close"}


@given(TEXTS)
@example("one\nkey = 1")
def test_a_comment_of_toml_stays_one(given: str) -> None:
    assert tomllib.loads(f"# {text.toml_comment(given)}\n") == {}


@given(st.lists(TEXTS, min_size=1, max_size=4))
def test_no_cell_of_a_table_is_a_formula(given: list[str]) -> None:
    cells = [text.csv_cell(one) for one in given]
    sheet = io.StringIO()
    csv.writer(sheet, lineterminator="\n").writerow(cells)
    for delimiter in ",;|\t":
        for row in csv.reader(io.StringIO(sheet.getvalue(), newline=""), delimiter=delimiter):
            assert not [cell for cell in row if re.match(r"\s*[=+\-@＝＋－＠]", cell)]


def test_cells_that_are_no_formulas_stay() -> None:
    for cell in (-1.5, 3, True, None, "steady feed", "2 m-1", "a=b", READABLE):
        assert text.csv_cell(cell) == cell


@pytest.mark.parametrize(
    "given", ["$\\marker{", "a $b$ c", "\\$", "$$", "\\alpha $", READABLE.replace("摩擦", "")]
)
def test_a_figure_draws_the_text(given: str) -> None:
    with house_style(), warnings.catch_warnings():
        drawing = Figure(figsize=(2.0, 1.0))
        drawn = drawing.text(0.5, 0.5, text.figure(given))
        drawing.canvas.draw_idle()
        shown, kind = drawn._preprocess_math(drawn.get_text())
    assert (shown, kind) == (given, False)
