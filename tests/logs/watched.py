"""Read logs while every event that Python tells of is watched: code, imports, files, network.

Run as ``python -m tests.logs.watched READER WARM FOLDER``: the files in WARM are read first, so
that imports are done; then those in FOLDER, and what happened is printed, one event a line. A
reader may do nothing but open its file and look at its own objects. What libraries in C do by
themselves is not told.
"""

import io
import os
import pickle
import sys
import warnings
from collections.abc import Callable
from pathlib import Path

HARMLESS = {"array.__new__", "builtins.id", "object.__getattr__", "sys._getframe"}
FREE_MEMORY = ("/proc/meminfo", "/proc/self/cgroup", "/sys/fs/cgroup/")
"""Where it is told how much memory is free."""


def ours(path: Path) -> None:
    """Read a file as we do."""
    from breakaway.errors import LogError
    from breakaway.measure.logs import read_log

    try:
        print(f"{path.name}: {read_log(path)['force_n'][6]:.6g} N")
    except LogError as error:
        print(error)


def by_asammdf(path: Path) -> None:
    """Read a file as asammdf does, with its conversions."""
    import asammdf

    with warnings.catch_warnings(), asammdf.MDF(path) as file:
        warnings.simplefilter("ignore")
        file.get("force_n")


def by_pickle(_: Path) -> None:
    """Look for a class by its name, as what unpickles does."""
    pickle.Unpickler(io.BytesIO()).find_class("fractions", "Fraction")


READERS: dict[str, Callable[[Path], None]] = {
    "ours": ours,
    "asammdf": by_asammdf,
    "pickle": by_pickle,
}


def main(reader: str, warm: Path, folder: Path) -> None:
    """Print what happens while the files of a folder are read."""
    for path in sorted(warm.iterdir()):
        READERS[reader](path)
    seen: list[str] = []
    place = ""

    def hook(event: str, arguments: tuple[object, ...]) -> None:
        if place and event not in HARMLESS and not _is_of_the_file(event, arguments, place):
            seen.append(f"event: {Path(place).name}: {event} {arguments!r:.100}")

    sys.addaudithook(hook)
    for path in sorted(folder.iterdir()):
        place = str(path)
        READERS[reader](path)
        place = ""
    print("\n".join(seen))


def _is_of_the_file(event: str, arguments: tuple[object, ...], place: str) -> bool:
    """Tell whether the file itself is opened to be read, or what tells the free memory."""
    if event != "open":
        return False
    name, _, flags = arguments
    is_reading = not int(str(flags)) & (os.O_WRONLY | os.O_RDWR | os.O_CREAT)
    return is_reading and (
        isinstance(name, int) or str(name) == place or str(name).startswith(FREE_MEMORY)
    )


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]))
