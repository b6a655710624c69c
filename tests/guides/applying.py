"""Do what a guide says: write the files that it gives whole, and make the changes that it shows.

A block whose opening line names a file after its language is that file. Where the language is
``diff``, the block is a change of it: lines that start with a blank are there already, those with
``-`` go, those with ``+`` come. ``@@`` parts one place from the next. A block ``console applied``
has the commands that are run afterwards.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

FENCED = re.compile(r"^```(?P<opening>.*)\n(?P<text>(?:.*\n)*?)^```$", re.M)
COMMANDS = "console applied"

Files = dict[str, bytes]
"""Path from the root of the tree -> content."""


@dataclass(frozen=True)
class Step:
    """What a guide does to one file."""

    language: str
    path: str
    text: str

    def apply(self, files: Files) -> None:
        """Do it to the files of a tree."""
        if self.language != "diff":
            assert self.path not in files, f"{self.path} is there already"
            files[self.path] = self.text.encode()
            return
        assert self.path in files, f"{self.path} is not there"
        content = files[self.path].decode()
        for place in self.text.split("@@\n"):
            content = self._changed(content, place)
        files[self.path] = content.encode()

    def _changed(self, content: str, place: str) -> str:
        lines = place.splitlines(keepends=True)
        before = "".join(line[1:] for line in lines if not line.startswith("+"))
        after = "".join(line[1:] for line in lines if not line.startswith("-"))
        found = f"\n{content}".count(f"\n{before}")
        assert before and found == 1, f"{self.path} has {found} places like this:\n{before}"
        return f"\n{content}".replace(f"\n{before}", f"\n{after}")[1:]


def steps(guide: Path) -> list[Step]:
    """Give what a guide does, in its order."""
    blocks = FENCED.finditer(guide.read_text(encoding="utf-8"))
    opened = [(block["opening"].split(" "), block["text"]) for block in blocks]
    return [Step(*words, text) for words, text in opened if len(words) == 2 and "." in words[1]]


def commands(guide: Path) -> list[str]:
    """Give the commands of a guide, in their order."""
    blocks = FENCED.finditer(guide.read_text(encoding="utf-8"))
    return [
        line
        for block in blocks
        if block["opening"] == COMMANDS
        for line in block["text"].splitlines()
    ]
