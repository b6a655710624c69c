"""Advice: how to get parts out, with what, set to what, and what it does to them."""

from __future__ import annotations

from breakaway.ask.advice.advising import advise
from breakaway.ask.advice.result import Advice
from breakaway.ask.advice.writing import write_advice

__all__ = ["Advice", "advise", "write_advice"]
