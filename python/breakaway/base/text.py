r"""Text of others where it is shown or written: one function for each target.

A name, a channel, a path or a description may hold anything. Each function here gives the text as
its target shows it, and nothing that the target obeys. TOML strings and JSON need none: what
writes them escapes.
"""

from __future__ import annotations

import html
import re

LONGEST_NAME = 100
"""Most characters of a name: file names and identifiers made of one stay within 255 bytes."""
LONGEST_VALUE = 80
"""Most characters of a value in a message."""
LONGEST_LABEL = 40
"""Most characters of a name at an axis: figures are 7 inches wide."""
LONGEST_LINE = 2000
"""Most characters of a line on a terminal that is no table."""

_HIDDEN = (
    "\x00-\x1f\x7f-\x9f"  # controls: C0, DEL, C1
    "\u00ad\u061c\u180e\u200b\u200e\u200f\u2060-\u206f\ufeff\ufff9-\ufffb\U000e0000-\U000e007f"
    "\u2028-\u202e"  # line and paragraph separators, embeddings and overrides of direction
    "\ud800-\udfff\ufffe\uffff"  # no characters at all
)
_HIDDEN_ANY = re.compile(f"[{_HIDDEN}]")
_HIDDEN_IN_LINES = re.compile(f"(?!\n)[{_HIDDEN}]")


def visible(text: str) -> str:
    r"""Give a text as one line that shows every character: hidden ones as escapes of Python.

    Hidden are controls, formats that change direction or have no width (UAX #9, but for the two
    joiners, which words and emoji need), separators of lines, and what is no character.

    Examples
    --------
    >>> print(visible("red\x1b[31m\n\u202egnp"))
    red\x1b[31m\n\u202egnp
    >>> visible("Größe µm 摩擦")
    'Größe µm 摩擦'

    """
    return _HIDDEN_ANY.sub(_escape, text)


def visible_lines(text: str) -> str:
    r"""Do the same, and let line feeds be.

    Examples
    --------
    >>> print(visible_lines("two\r\nlines"))
    two\r
    lines

    """
    return _HIDDEN_IN_LINES.sub(_escape, text)


def terminal(text: str) -> str:
    r"""Give lines for a terminal: no escape sequences (ECMA-48), no line without end.

    Examples
    --------
    >>> print(terminal("\x1b]0;title\x07"))
    \x1b]0;title\x07

    """
    return "\n".join(_cut(line, LONGEST_LINE) for line in visible_lines(text).split("\n"))


def shown(value: object) -> str:
    """Give a value for a message: as Python writes it, on one line, and not too long.

    Examples
    --------
    >>> shown("1 kg"), shown(-1.0)
    ("'1 kg'", '-1.0')
    >>> shown("x" * 1000)[-26:]
    "'... (of 1,000 characters)"

    """
    if isinstance(value, str) and len(value) > LONGEST_VALUE:
        return f"{value[:LONGEST_VALUE]!r}... (of {len(value):,} characters)"
    return brief(repr(value))


def brief(name: str) -> str:
    r"""Give a name out of a file, such as that of a column, for a message: one line, not too long.

    Examples
    --------
    >>> print(brief("force\n(N)"))
    force\n(N)

    """
    return _cut(visible(name), LONGEST_VALUE)


def c_comment(text: str) -> str:
    r"""Give a text for within a comment of C or C++, of a block or to the end of a line.

    It neither ends nor opens a comment (C99 6.4.9), is no trigraph (5.2.1.1), splices no lines
    (5.1.1.2), holds no command of Doxygen, and is ASCII, which every source character set has.

    Examples
    --------
    >>> print(c_comment("20 µm */ int marker; /* ??/ \\"))
    20 \xb5m *\x2f int marker; /\x2a ?\x3f/ \x5c

    """
    text = text.replace("\\", r"\x5c").replace("@", r"\x40")
    text = text.replace("??", r"?\x3f").replace("*/", r"*\x2f").replace("/*", r"/\x2a")
    return visible(text).encode("ascii", "backslashreplace").decode()


def c_identifier(text: str) -> str:
    """Give what of a text an identifier of C and a file name can have; it may be empty.

    Examples
    --------
    >>> c_identifier("../my joint, 2 mm"), c_identifier("摩擦")
    ('my_joint_2_mm', '')

    """
    return re.sub(r"[^A-Za-z0-9_]+", "_", text)[:LONGEST_NAME].strip("_")


def xml(text: str) -> str:
    """Give a text for XML 1.0 or HTML, as content or as a quoted value of an attribute.

    What XML forbids even as a reference (2.2, Char) is shown as ``visible`` does.

    Examples
    --------
    >>> xml("<b> & 'co'")
    '&lt;b&gt; &amp; &#x27;co&#x27;'

    """
    return html.escape(visible(text))


def markdown(text: str) -> str:
    r"""Give a text for within a line or a table's cell of Markdown (CommonMark 2.4, and GitHub's).

    Examples
    --------
    >>> print(markdown("a | *b* `c` <d> paper_as_computed"))
    a \| \*b\* \`c\` \<d\> paper_as_computed

    """
    escaped = re.sub(r"[!#$&*<>\[\]\\^`{|}~]|(?<![^\W_])_|_(?![^\W_])", r"\\\g<0>", visible(text))
    return re.sub(r"^(\s*\d*)([-+=.)])", r"\1\\\2", escaped)


def toml_comment(text: str) -> str:
    r"""Give a text for within a comment of TOML, which ends with its line.

    Examples
    --------
    >>> print("# " + toml_comment("steady\nkey = 1"))
    # steady\nkey = 1

    """
    return visible(text)


def csv_cell(value: object) -> object:
    """Give a cell that no spreadsheet computes; numbers, truths and nothing stay what they are.

    Where a text begins as a formula does, also behind a mark that some take to part cells, an
    apostrophe goes before it, as OWASP advises (CSV injection). The delimiter and quotes are left
    to what writes the table.

    Examples
    --------
    >>> csv_cell("=1+1"), csv_cell("a;=1+1"), csv_cell("steady feed"), csv_cell(-1.5)
    ("'=1+1", "a;'=1+1", 'steady feed', -1.5)

    """
    return _FORMULA.sub("'", visible(value)) if isinstance(value, str) else value


_FORMULA = re.compile(r"(?:^|(?<=[;|]))(?=\s*[=+\-@＝＋－＠])")
"""Before a formula: at the beginning, or behind a mark that is not quoted for being there."""


def figure(text: str) -> str:
    r"""Give a text for a figure of matplotlib, in which $ begins no formula; one line.

    Examples
    --------
    >>> print(figure(r"costs $5 or $\marker{"))
    costs \$5 or \$\marker{

    """
    return visible(text).replace("$", r"\$")


def label(text: str) -> str:
    """Give a name for an axis or a legend of a figure: as ``figure`` does, and not too long.

    Examples
    --------
    >>> label("steady feed"), len(label("x" * 100))
    ('steady feed', 40)

    """
    return figure(text if len(text) <= LONGEST_LABEL else f"{text[: LONGEST_LABEL - 1]}…")


def _escape(found: re.Match[str]) -> str:
    return found[0].encode("unicode_escape").decode()


def _cut(text: str, most: int) -> str:
    return text if len(text) <= most else f"{text[:most]}... (of {len(text):,} characters)"
