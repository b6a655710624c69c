"""What all tests share."""

import os
import signal
import socket
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from hypothesis import settings

# The same examples in every run, on every machine, however slow it is.
settings.register_profile("breakaway", derandomize=True, deadline=None, database=None)
settings.load_profile("breakaway")


def _socket(path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(path.name)  # from its folder: a longer path would not do


def _link_to_pipe(path: Path) -> None:
    os.mkfifo(path.with_suffix(".pipe"))
    path.symlink_to(path.with_suffix(".pipe"))


NO_FILES: dict[str, tuple[Callable[[Path], None], str]] = {
    "folder": (Path.mkdir, "is a folder, not a file"),
    "pipe": (os.mkfifo, "is a pipe, not a file"),
    "link_to_pipe": (_link_to_pipe, "is a pipe, not a file"),
    "socket": (_socket, "is a socket, not a file"),
    "device": (lambda path: path.symlink_to("/dev/zero"), "is a device, not a file"),
}


@pytest.fixture(params=NO_FILES)
def no_file(
    request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[tuple[Path, str]]:
    """Give what is at a path but is no regular file, and what an error says; waiting fails."""
    make, words = NO_FILES[request.param]
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "special.toml"
    make(path)

    def give_up(*_: object) -> None:
        raise AssertionError("it waits for what is no file")

    before = signal.signal(signal.SIGALRM, give_up)
    signal.alarm(20)
    yield path, words
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)
