"""Read arrays of numbers from pickled files without running anything that they name.

A pickle is a program: it may call any function of Python. Here it can reach only makers of arrays,
which are objects of this module and not of NumPy or PyTorch. Every other name is refused, and so
are the opcodes that arrays do not need. The pure Python unpickler of the standard library is used,
since the fast one reserves memory for any index that a file states.
"""

from __future__ import annotations

import io
import math
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.errors import InputError
from kilter.files.limits import MOST_TABLE_BYTES, require_unfolded

REFUSED = "only arrays of numbers are read from a pickle"
"""Remedy of a pickle with other content."""
KINDS = "fiu"
"""Kinds of numbers that are read: floats, and integers with and without a sign."""
NOT_NEEDED = (
    pickle.SETITEM, pickle.SETITEMS, pickle.ADDITEMS, pickle.FROZENSET,
    pickle.EXT1, pickle.EXT2, pickle.EXT4, pickle.NEWOBJ, pickle.NEWOBJ_EX, pickle.INST, pickle.OBJ,
)  # fmt: skip
"""Opcodes that arrays do not need; some of them make small files slow or large."""
STORAGES = {
    "DoubleStorage": "<f8",
    "FloatStorage": "<f4",
    "LongStorage": "<i8",
    "IntStorage": "<i4",
}
"""Types of numbers of the storages of PyTorch."""


class Maker:
    """A function that a pickle may call; the pickle cannot change it."""

    __slots__ = ("_make",)

    def __init__(self, make: Callable[..., Any]) -> None:
        self._make = make

    def __call__(self, *given: Any) -> Any:
        """Call the function."""
        return self._make(*given)

    def __setstate__(self, state: Any) -> None:
        raise InputError("it changes a function", hint=REFUSED)


class Kind:
    """The type of the numbers of an array."""

    __slots__ = ("type",)

    def __init__(self, code: Any, *_: Any) -> None:
        self.type = np.dtype(str(code))
        if self.type.kind not in KINDS:
            raise InputError("its arrays do not hold plain numbers", hint=REFUSED)

    def __setstate__(self, state: Any) -> None:
        self.type = self.type.newbyteorder(">" if state[1] == ">" else "<")


class Numbers:
    """An array that its pickle states by shape, type and bytes."""

    __slots__ = ("array",)

    def __init__(self, *_: Any) -> None:
        self.array: Array | None = None

    def __setstate__(self, state: Any) -> None:
        _, shape, kind, by_columns, raw = state
        self.array = _filled(raw, kind, shape, "F" if by_columns else "C")


def _filled(raw: Any, kind: Kind, shape: Any, order: Any = "C") -> Array:
    """An array of a shape from its bytes; an error if their number is another one."""
    data = raw if isinstance(raw, bytes) else bytes(raw)
    if any(type(n) is not int or n < 0 for n in shape):
        raise InputError("an array has an invalid shape", hint=REFUSED)
    if math.prod(shape) * kind.type.itemsize != len(data):
        raise InputError("an array has another size than its bytes", hint=REFUSED)
    return np.frombuffer(data, kind.type).reshape(shape, order="F" if order == "F" else "C")


def _from_buffer(raw: Any, kind: Kind, shape: Any, order: Any) -> Numbers:
    """An array of the fifth protocol of pickles."""
    made = Numbers()
    made.array = _filled(raw, kind, shape, order)
    return made


def _latin(text: Any, coding: Any) -> bytes:
    """Bytes that old protocols of pickles write as text."""
    if coding != "latin1":
        raise InputError("it holds encoded text", hint=REFUSED)
    return str(text).encode("latin1")


def _tensor(storage: Any, offset: Any, size: Any, stride: Any, *_: Any) -> Numbers:
    """A contiguous tensor of PyTorch, as an array."""
    steps = [math.prod(size[k + 1 :]) for k in range(len(size))]
    if list(stride) != steps or not isinstance(storage, np.ndarray):
        raise InputError("a tensor is not contiguous", hint="save tensor.contiguous().numpy()")
    count = math.prod(size)
    if offset < 0 or offset + count > len(storage):
        raise InputError("a tensor is longer than its storage", hint=REFUSED)
    made = Numbers()
    made.array = storage[offset : offset + count].reshape(size)
    return made


_CORES = ("numpy.core", "numpy._core")
MAKERS: dict[tuple[str, str], Callable[..., Any]] = {
    **{(f"{core}.multiarray", "_reconstruct"): Numbers for core in _CORES},
    **{(f"{core}.numeric", "_frombuffer"): _from_buffer for core in _CORES},
    ("numpy", "ndarray"): Numbers,
    ("numpy", "dtype"): Kind,
    ("_codecs", "encode"): _latin,
    ("torch._utils", "_rebuild_tensor_v2"): _tensor,
    ("collections", "OrderedDict"): lambda *_: None,
    **{("torch", name): Kind for name in STORAGES},
}
"""Makers by the module and the name in a pickle."""


_PURE: Any = pickle._Unpickler


class _NumberReader(_PURE):  # type: ignore[misc]
    """An unpickler that knows only the makers of arrays."""

    def __init__(self, data: bytes, stored: Callable[[str], bytes]) -> None:
        super().__init__(io.BytesIO(data))
        self._stored, self._size = stored, len(data)
        left_out = {code[0] for code in NOT_NEEDED}
        acts = {code: act for code, act in super().dispatch.items() if code not in left_out}
        self.dispatch = {**acts, pickle.BYTEARRAY8[0]: _NumberReader._load_bytes}

    def _load_bytes(self) -> None:
        """Read bytes after their number; the standard library reserves memory for any number."""
        count = int.from_bytes(self.read(8), "little")
        if count > self._size:
            raise InputError("the pickle is cut off", hint="write the file anew")
        self.append(self.read(count))

    def find_class(self, module: str, name: str) -> Any:
        """The maker that a pickle names; an error for any other name."""
        if module == "torch" and name in STORAGES:
            return Kind(STORAGES[name])
        make = MAKERS.get((module, name))
        if make is None:
            raise InputError(f"the pickle names {module}.{name!s:.60}", hint=REFUSED)
        return Maker(make)

    def persistent_load(self, given: Any) -> Any:
        """The numbers of a storage of PyTorch, which lie in a file of the archive."""
        word, kind, key, *_ = given
        if word != "storage" or not isinstance(kind, Kind):
            raise InputError("the pickle names an object outside of it", hint=REFUSED)
        data = self._stored(str(key))
        return np.frombuffer(data, kind.type)


def unpickled(data: bytes, stored: Callable[[str], bytes] | None = None) -> Array:
    """The array of numbers in a pickle; a list of arrays of one shape is stacked.

    Arguments: `stored`: function that returns the bytes of a storage of PyTorch by its key.
    Raises `InputError` if the pickle is damaged, or holds or names anything else.
    """

    def nothing(key: str) -> bytes:
        raise InputError("the pickle names an object outside of it", hint=REFUSED)

    try:
        value = _NumberReader(data, stored or nothing).load()
    except InputError:
        raise
    except KeyError:  # an opcode that arrays do not need
        raise InputError("the pickle holds something else than an array", hint=REFUSED) from None
    except Exception as error:  # a damaged pickle fails in any operation
        raise InputError(
            f"the pickle is damaged: {type(error).__name__}", hint="write the file anew"
        ) from None
    rows = value if isinstance(value, list) else [value]
    arrays = [row.array for row in rows if isinstance(row, Numbers) and row.array is not None]
    if not arrays or len(arrays) < len(rows) or len({array.shape for array in arrays}) > 1:
        raise InputError("the pickle holds something else than an array", hint=REFUSED)
    return np.array(arrays if isinstance(value, list) else arrays[0], dtype=float)


def archived(data: bytes) -> Array:
    """The array in an archive of PyTorch, whose file ``data.pkl`` is a pickle.

    Raises `InputError` if the archive is damaged, too large, or holds anything else.
    """
    import zipfile

    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        require_unfolded(sum(entry.file_size for entry in archive.infolist()), len(data))
        names = archive.namelist()
        chosen = [name for name in names if name.split("/")[-1] == "data.pkl"]
        if len(chosen) != 1:
            raise InputError("the zip holds no file data.pkl", hint="give an archive of PyTorch")
        folder = chosen[0].removesuffix("data.pkl")

        def stored(key: str) -> bytes:
            return archive.read(f"{folder}data/{key}")

        content = archive.read(chosen[0])
        if len(content) > MOST_TABLE_BYTES:
            raise InputError("the pickle is too large", hint="split the file")
        return unpickled(content, stored)
