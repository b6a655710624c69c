"""MDF 4 files, read by code of our own: no formula, markup or attachment of a file is run."""

from breakaway.measure.logs.mdf.reader import open_mdf

__all__ = ["open_mdf"]
