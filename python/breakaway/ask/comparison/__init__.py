"""Comparisons: methods of extraction side by side, on the same parts of a population."""

from __future__ import annotations

from breakaway.ask.comparison.asked import Asked
from breakaway.ask.comparison.comparing import Comparison, compare_methods

__all__ = ["Asked", "Comparison", "compare_methods"]
