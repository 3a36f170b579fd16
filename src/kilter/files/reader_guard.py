"""Guard around a reader of another program's format: errors of damaged data are wrong input.

Readers meet damaged data in many places: in their own code, and in libraries that raise exceptions
of many kinds. The guard turns the exceptions of `DAMAGE` into an `InputError` with the library's
reason. All other exceptions pass, since they are faults of kilter itself.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path

from kilter.errors import InputError, visible

__all__ = ["DAMAGE", "LIBRARY_DAMAGE", "reader_guard", "reason_of"]

DAMAGE = (
    ValueError,
    LookupError,
    ArithmeticError,
    EOFError,
    OSError,
    NotImplementedError,
    RecursionError,
)
"""Exceptions of Python that damaged data may cause in any reader. `TypeError`, `AttributeError`,
`AssertionError` and `RuntimeError` are absent: they are faults of kilter."""
LIBRARY_DAMAGE = frozenset(
    {
        "_csv.Error",
        "lzma.LZMAError",
        "_lzma.LZMAError",
        "scipy.spatial._qhull.QhullError",
        "shapely.errors.ShapelyError",
        "struct.error",
        "zipfile.BadZipFile",
        "zlib.error",
    }
)
"""Exceptions of libraries for damaged data, by name, since most readers do not load the library."""
LONGEST = 160
"""Largest length of a library's reason [characters]."""


@contextmanager
def reader_guard(file: str | Path, also: Collection[str] = ()) -> Iterator[None]:
    """Turn the exceptions of a damaged file into an `InputError` that names the file.

    Arguments: `also`: names of further exceptions that the reader of this format may raise, as
    "module.Class". Raises `InputError` if the reader raises it, or an exception of damaged data.

    Examples
    --------
    >>> with reader_guard("wall.csv"):
    ...     int("12a")
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: wall.csv: the file is damaged: invalid literal for int() with ...
    """
    try:
        yield
    except InputError as error:
        raise error.located(file=str(file)) from None
    except BrokenPipeError:
        raise  # the reader of the answer has gone; the file is not damaged
    except Exception as error:
        if not _is_damage(error, also):
            raise
        raise InputError(
            f"the file is damaged: {reason_of(error)}", file=str(file), hint="export it anew"
        ) from error


def _is_damage(error: Exception, also: Collection[str]) -> bool:
    """Whether damaged data may raise this exception."""
    if isinstance(error, DAMAGE):
        return True
    names = {f"{kind.__module__}.{kind.__qualname__}" for kind in type(error).__mro__}
    return not names.isdisjoint(LIBRARY_DAMAGE) or not names.isdisjoint(also)


def reason_of(error: Exception) -> str:
    """The message of an exception as a clause in one line; the name of its type without a message.

    Examples
    --------
    >>> reason_of(ValueError("bad  \\x1b[2J\\n  number."))
    'bad \\\\x1b[2J number'
    >>> reason_of(KeyError())
    'KeyError'
    """
    words = getattr(error, "strerror", None) or str(error)  # without the path
    text = " ".join(words.split()).rstrip(".")
    return visible(text)[:LONGEST] or type(error).__name__
