"""MDF 4 files, read by code of our own: no formula, markup or attachment of a file is run."""

from breakaway.measure.logs.mdf.reader import read_mdf

__all__ = ["read_mdf"]
