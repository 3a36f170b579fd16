"""Data inside an HTML page: arrays as base64, and JSON that cannot end its script element.

The bytes of a long array are compressed (zlib, RFC 1950): contact points, edges and triangles take
a third of their length.
"""

from __future__ import annotations

import base64
import json
import zlib
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from kilter.arrays import Array

CODES = {"f4": "<f4", "f8": "<f8", "u1": "|u1", "u2": "<u2", "u4": "<u4"}
"""Types of packed arrays, as little-endian NumPy types."""
COMPRESSED = 512
"""Least length of an array that is compressed [bytes]."""
ESCAPED = {"<": "\\u003c", ">": "\\u003e", "&": "\\u0026"}


def pack(values: ArrayLike, code: str = "f4") -> dict[str, Any]:
    """Encode an array as JSON data: its type, and its bytes in base64.

    `code` is f4, f8, u1, u2 or u4. "index" selects u2 if all values fit, else u4. The entry is
    "data" for plain bytes and "zlib" for compressed bytes.

    Raises `KeyError` if `code` is unknown.

    Examples
    --------
    >>> pack([1, 2], "index")
    {'type': 'u2', 'data': 'AQACAA=='}
    """
    array = np.asarray(values)
    if code == "index":
        code = "u2" if array.max(initial=0) < 2**16 else "u4"
    kind: DTypeLike = np.dtype(CODES[code])
    data = np.ascontiguousarray(array, dtype=kind).tobytes()
    compressed = zlib.compress(data) if len(data) >= COMPRESSED else data
    if len(compressed) < len(data):
        return {"type": code, "zlib": base64.b64encode(compressed).decode("ascii")}
    return {"type": code, "data": base64.b64encode(data).decode("ascii")}


def unpack(packed: dict[str, Any]) -> Array:
    """Decode an array that `pack` encoded; it has one dimension.

    Examples
    --------
    >>> unpack(pack([1, 2], "f8"))
    array([1., 2.])
    """
    if "zlib" in packed:
        data = zlib.decompress(base64.b64decode(packed["zlib"]))
    else:
        data = base64.b64decode(packed["data"])
    return np.frombuffer(data, CODES[packed["type"]])


def as_json(data: Any) -> str:
    """Encode data as ASCII JSON without ``<``, ``>`` and ``&``, safe in a script element.

    Examples
    --------
    >>> as_json({"name": "</script>"})
    '{"name":"\\\\u003c/script\\\\u003e"}'
    """
    text = json.dumps(data, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    for sign, code in ESCAPED.items():
        text = text.replace(sign, code)
    return text


def readable(name: str) -> str:
    """Replace the characters of a name that cannot be displayed by U+FFFD.

    These are line breaks, control characters, lone surrogates and characters that change the
    direction of the text.

    Examples
    --------
    >>> readable("a\\u202eb") == "a\\ufffdb"
    True
    """
    if name.isprintable():
        return name
    return "".join(c if c.isprintable() else "\ufffd" for c in name)
