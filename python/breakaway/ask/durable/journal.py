"""The finished files of a folder, each with a digest, so that no other is taken for one of them.

A digest covers the identity of the work, the name of the file and all its bytes: an edited file,
one of other work, or one in the place of another has another digest. The digests stand in a
journal beside the manifest, a line each. A line is written before its file is: what a killed
process leaves is at most a line without a file, never a file without a line.

Digests tell mix-ups, edits and damage. They are no signature: who writes both file and journal can
write what he likes.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from breakaway.base.output import append_inside, remove_inside, write_inside
from breakaway.base.ownership import refuse_links
from breakaway.base.reading import open_regular
from breakaway.errors import StudyError

PIECES = "pieces"
"""Folder of the pieces, within that of the work."""
DIGESTS = "digests.txt"
"""The journal: a digest and a name in each line."""
MOST_DIGESTS_BYTES = 256 * 2**20
"""Most bytes of a journal: two million files."""
LINE = re.compile(rf"([0-9a-f]{{64}})  ((?:{PIECES}/)?[^\s./\\][^/\\]*)")
"""A digest, and a name in the folder or in that of its pieces: nothing beyond is looked at."""
BLOCK_BYTES = 2**20
MISSING = "is missing"

Signature = tuple[int, int, int]
"""Number, size and time of a file: while they stay, its content is taken to."""


def digest_of(identity: str, name: str, content: bytes) -> str:
    """Give the digest of a finished file.

    Parameters
    ----------
    identity : str
        Digest of all that determines the work.
    name : str
        Place of the file in its folder.
    content : bytes
        What it holds.

    Examples
    --------
    >>> digest_of("a", "b", b"c")[:8] == digest_of("ab", "", b"c")[:8]
    False

    """
    found = _begun(identity, name)
    found.update(content)
    return found.hexdigest()


def _begun(identity: str, name: str) -> hashlib._Hash:
    return hashlib.sha256(f"{identity}\n{name}\n".encode())


class Journal:
    """The finished files of a folder."""

    def __init__(self, folder: Path, identity: str) -> None:
        self.folder = folder
        """Where they are."""
        self.identity = identity
        """Digest of all that determines the work."""
        self._known: dict[str, str] = {}
        self._sound: dict[str, tuple[str, Signature]] = {}
        self.reread()

    def reread(self) -> None:
        """Read the journal, to which another process may have added; damaged lines do not count.

        Raises
        ------
        StudyError
            It cannot be read.

        """
        path = self.folder / DIGESTS
        try:
            with open_regular(path) as file:
                content = file.read(MOST_DIGESTS_BYTES + 1)
            if len(content) > MOST_DIGESTS_BYTES:
                raise OSError(f"has more than {MOST_DIGESTS_BYTES} bytes")  # noqa: TRY301
        except FileNotFoundError:
            content = b""
        except OSError as error:
            raise StudyError(
                f"{path}: cannot be read: {error.strerror or error}; remove it, and go on with "
                "--resume to compute everything again"
            ) from None
        lines = content.decode("utf-8", "replace").split("\n")[:-1]
        self._known = {match[2]: match[1] for line in lines if (match := LINE.fullmatch(line))}

    def names(self, prefix: str = "") -> list[str]:
        """Give the names of all files that have a digest, and start so."""
        return sorted(name for name in self._known if name.startswith(prefix))

    def flaw(self, name: str) -> str | None:
        """Say in what a file differs from the one that was written, None where in nothing.

        Nothing of a file is parsed before this was asked.
        """
        path = self.folder / name
        try:
            signature = _signature(path)
            if (self._known.get(name), signature) == self._sound.get(name):
                return None
            found = self._digest_of_file(path, name)
        except FileNotFoundError:
            return MISSING
        except OSError as error:
            return f"cannot be read ({error.strerror or error})"
        if name not in self._known:
            return f"has no digest in {DIGESTS}"
        if found != self._known[name]:
            return f"is not the one that was written (see {DIGESTS})"
        self._sound[name] = found, signature
        return None

    def refuse_flawed(self, name: str) -> None:
        """Refuse to read a file that is not the one that was written.

        Raises
        ------
        StudyError
            It is not.

        """
        flaw = self.flaw(name)
        if flaw is not None:
            raise StudyError(
                f"{self.folder / name}: {flaw}; go on with --resume to compute it again"
            )

    def write(self, name: str, content: bytes) -> None:
        """Write a file, whole or not at all, its digest first.

        Raises
        ------
        OutputError
            It cannot be written, or goes through a symbolic link.

        """
        path = self.folder / name
        if path.parent != self.folder:
            refuse_links(path.parent)
        self._note({name: digest_of(self.identity, name, content)})
        write_inside(path, content)
        self._sound[name] = self._known[name], _signature(path)

    def note_staged(self, staging: Path) -> list[str]:
        """Note the digests of files that are moved to the folder next, and give their names."""
        names = sorted(path.name for path in staging.iterdir())
        self._note({name: self._digest_of_file(staging / name, name) for name in names})
        return names

    def note_written(self, name: str) -> None:
        """Note the digest of a file that grew line by line, and is finished."""
        self._note({name: self._digest_of_file(self.folder / name, name)})

    def remove(self, name: str) -> None:
        """Remove a file that has a digest."""
        remove_inside(self.folder / name)
        self._known.pop(name, None)

    def settle(self, names: Iterable[str]) -> None:
        """Reduce the journal to these names, in their alphabetical order."""
        self._known = {name: self._known[name] for name in sorted(names)}
        content = _lines(self._known)
        path = self.folder / DIGESTS
        if (path.read_bytes() if path.exists() else b"") != content:
            write_inside(path, content)

    def _note(self, digests: Mapping[str, str]) -> None:
        new = {name: d for name, d in digests.items() if self._known.get(name) != d}
        if new:
            append_inside(self.folder / DIGESTS, _lines(new))
            self._known |= new

    def _digest_of_file(self, path: Path, name: str) -> str:
        found = _begun(self.identity, name)
        with open_regular(path) as file:
            while block := file.read(BLOCK_BYTES):
                found.update(block)
        return found.hexdigest()


def _lines(digests: Mapping[str, str]) -> bytes:
    return "".join(f"{digest}  {name}\n" for name, digest in digests.items()).encode()


def _signature(path: Path) -> Signature:
    found = path.stat()
    return found.st_ino, found.st_size, found.st_mtime_ns
