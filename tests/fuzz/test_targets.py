"""Every fuzzed target stands good files and some thousand seeded damages of them.

``python -m fuzz`` looks for more, guided by coverage; see fuzz/README.md.
"""

import os
import random
import socket
import subprocess
import sys
from pathlib import Path

import pytest
from fuzz.seeds import seeds
from fuzz.targets import TARGETS, run

DAMAGES = {"log": 80, "toml": 60, "study": 8}
"""Damaged copies of the good files of a target, by kind; a study takes a fifth of a second."""

WORDS = (
    b"\0",
    b"\n",
    b'"',
    b"'''",
    b"]]",
    b"{",
    b"=",
    b".",
    b"\xff\xfe",
    b"9" * 40,
    b"1e999",
    b"nan",
)


def damaged(content: bytes, dice: random.Random) -> bytes:
    """Flip, cut, repeat or insert."""
    data = bytearray(content)
    for _ in range(dice.choice((1, 2, 8))):
        place = dice.randrange(len(data) + 1)
        match dice.randrange(5):
            case 0 if place < len(data):
                data[place] ^= 1 << dice.randrange(8)
            case 1:
                del data[place : place + dice.choice((1, 8, 100))]
            case 2:
                data[place:place] = data[place : place + dice.choice((4, 64, 1000))]
            case 3:
                data[place:place] = dice.choice(WORDS)
            case _:
                data[place : place + 8] = dice.choice((b"\xff" * 8, b"\0" * 8, dice.randbytes(8)))
    return bytes(data)


@pytest.mark.slow
@pytest.mark.parametrize("name", TARGETS)
def test_a_target_stands_damage(name: str, tmp_path: Path) -> None:
    dice = random.Random(name)
    whole = seeds(name)
    for content in whole:
        run(TARGETS[name], content, tmp_path)
    for _ in range(DAMAGES[name.partition("_")[0]]):
        run(TARGETS[name], damaged(dice.choice(whole), dice), tmp_path)


def test_a_target_that_writes_elsewhere_is_noticed(tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"

    def writes(_: bytes, folder: Path) -> None:
        (folder / "here").write_bytes(b"")
        elsewhere.write_bytes(b"")

    def starts(_: bytes, __: Path) -> None:
        subprocess.run([sys.executable, "-c", ""], check=True)

    def connects(_: bytes, __: Path) -> None:
        with socket.socket() as one:
            one.connect_ex(("127.0.0.1", 9))

    def removes(_: bytes, __: Path) -> None:
        os.remove(elsewhere)  # noqa: PTH107

    for target, told in (
        (writes, r"\['open .*elsewhere'\]"),
        (removes, "os.remove .*elsewhere"),
        (starts, "subprocess.Popen"),
        (connects, "socket.connect"),
    ):
        with pytest.raises(AssertionError, match=told):
            run(target, b"", tmp_path)
