"""The code that was simulated, as code that runs elsewhere."""

from __future__ import annotations

from breakaway.export.c_files import ExportedC, export_c

__all__ = ["ExportedC", "export_c"]
