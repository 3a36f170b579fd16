"""Import scipy without the submodules of numpy that kilter does not use.

Scipy copies the namespace of numpy while it is imported (`scipy._lib.array_api_compat`). The copy
loads all submodules of numpy, among them `f2py` and `testing`, and takes longer than the rest
of `scipy.sparse`. During this import, numpy therefore does not list these submodules. They remain
importable. Only the command line does this.
"""

from __future__ import annotations

import sys

__all__ = ["import_scipy_quickly"]

UNUSED = ("char", "core", "ctypeslib", "f2py", "ma", "polynomial", "rec", "strings", "testing")
"""Submodules of numpy that the import of scipy does not need."""


def import_scipy_quickly() -> None:
    """Import `scipy.sparse` while numpy does not list the submodules that scipy does not need."""
    import numpy

    listed, names = getattr(numpy, "__dir__", None), numpy.__all__
    if listed is None or "scipy.sparse" in sys.modules:
        return
    try:
        numpy.__all__ = [name for name in names if name not in UNUSED]
        vars(numpy)["__dir__"] = lambda: [name for name in listed() if name not in UNUSED]
        import scipy.sparse  # noqa: F401
    finally:
        numpy.__all__, vars(numpy)["__dir__"] = names, listed
