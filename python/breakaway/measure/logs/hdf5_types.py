"""Types of HDF5 data that h5py makes of a text in the file, which numpy takes apart as code.

Opaque data may carry a text such as ``NUMPY:(2,)f4``. To tell its dtype, h5py hands the text to
numpy, and that compiles its first part as a literal. Such data is no number of ours, so its
dtype is never asked for.
"""

from __future__ import annotations

from typing import Any

DEEPEST = 8
"""Most types within each other; deeper ones are taken for opaque."""


def is_opaque(h5py: Any, kind: Any, depth: int = 0) -> bool:  # noqa: ANN401 - h5py has no types
    """Tell whether a type of HDF5 is opaque, or holds one that is."""
    h5t = h5py.h5t
    if depth > DEEPEST:
        return True
    match kind.get_class():
        case h5t.OPAQUE:
            return True
        case h5t.COMPOUND:
            members = (kind.get_member_type(k) for k in range(kind.get_nmembers()))
            return any(is_opaque(h5py, member, depth + 1) for member in members)
        case h5t.ARRAY | h5t.VLEN | h5t.ENUM:
            return is_opaque(h5py, kind.get_super(), depth + 1)
    return False
