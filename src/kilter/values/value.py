"""Value: the base class of frozen values that are compared and hashed by content.

The content of a value is the tuple of its fields. Arrays are compared by their numbers, so that
values with arrays can be members of sets and keys of dictionaries.
"""

from __future__ import annotations

import dataclasses
import hashlib
from typing import Any

import numpy as np

from kilter.values.guesses import Guessable


class Value(Guessable):
    """A frozen value that is compared by content; the hash is computed once and kept.

    Fields of a dataclass that are declared with ``compare=False`` do not count.

    Examples
    --------
    >>> @dataclasses.dataclass(frozen=True, slots=True, eq=False)
    ... class Row(Value):
    ...     numbers: Any
    >>> Row(np.array([1.0, 0.0])) == Row(np.array([1.0, -0.0]))
    True
    >>> len({Row(np.array([1.0])), Row(np.array([1.0])), Row(np.array([2.0]))})
    2
    >>> Row((1.0, 2.0)) == (1.0, 2.0)
    False
    """

    __slots__ = ("_hash",)

    _hash: int

    def _content(self) -> tuple[Any, ...]:
        """The values that are compared, in order."""
        fields = dataclasses.fields(self)  # type: ignore[arg-type]
        return tuple(getattr(self, field.name) for field in fields if field.compare)

    def __eq__(self, other: object) -> bool:
        if self is other:
            return True
        if not isinstance(other, Value) or type(other) is not type(self):
            return NotImplemented
        return hash(self) == hash(other) and _equal(self._content(), other._content())

    def __hash__(self) -> int:
        try:
            return self._hash
        except AttributeError:
            digest = hashlib.blake2b(digest_size=8)
            _add(digest, self._content())
            # the digest is the same in every process, so a pickled hash stays valid
            value = int.from_bytes(digest.digest(), "big", signed=True)
            object.__setattr__(self, "_hash", value)
            return value


def _equal(a: Any, b: Any) -> bool:
    """Whether two contents are equal: arrays by shape and numbers, sequences by their entries."""
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return bool(np.array_equal(a, b))
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b) and all(_equal(p, q) for p, q in zip(a, b, strict=True))
    return bool(a == b)


def _add(digest: Any, value: Any) -> None:
    """Feed a value to a hash function; equal values feed the same bytes."""
    if isinstance(value, np.ndarray):
        digest.update(str(value.shape).encode())
        digest.update((value.astype(np.float64) + 0.0).tobytes())  # -0.0 becomes 0.0
    elif isinstance(value, tuple):
        digest.update(b"(%d" % len(value))
        for entry in value:
            _add(digest, entry)
    elif isinstance(value, Value):
        digest.update(hash(value).to_bytes(9, "big", signed=True))
    elif isinstance(value, bool | int | float):
        digest.update(repr(float(value) + 0.0).encode())
    else:
        digest.update(str(value).encode() + b"\0")
