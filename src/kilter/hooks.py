"""Functions by name: upper packages define them, lower packages call them.

A method such as `Assembly.to_mjcf` needs a function of an upper package, but an import of that
package would close a circle. The lower package therefore calls the function by a name that
`kilter/__init__.py` registers, and imports no upper module.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

Function = Callable[..., Any]

_LOADERS: dict[str, Callable[[], Function]] = {}
"""For each registered name, a function that imports the module and returns the registered function.
"""


def register(name: str, loader: Callable[[], Function]) -> None:
    """Register the loader of a function, for calls by name from lower packages."""
    _LOADERS[name] = loader


def hook(name: str) -> Function:
    """Return the function that is registered under a name.

    Raises `KeyError` if no function has that name.

    Examples
    --------
    >>> register("double", lambda: lambda x: 2 * x)
    >>> hook("double")(4)
    8
    """
    return _LOADERS[name]()
