"""Exceptions in a reader: those of damaged data are wrong input, the others are our own faults."""

from __future__ import annotations

import csv
import lzma
import struct
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from kilter import InputError
from kilter.errors import TimeLimitReached
from kilter.files.reader_guard import reader_guard


def deep(depth: int = 0) -> int:
    return deep(depth + 1)


DAMAGED: dict[str, Callable[[], object]] = {
    "no number": lambda: int("x"),
    "no index": lambda: [0][1],
    "no encoding": lambda: b"x".decode("no-such-encoding"),
    "no text": lambda: b"\xff".decode(),
    "an overflow": lambda: int(float("inf")),
    "no axis": lambda: np.sum(np.zeros(3), axis=2),
    "an inverse": lambda: np.linalg.inv(np.zeros((2, 2))),
    "too deep": deep,
    "csv": lambda: list(csv.reader(["a\rb"])),
    "zlib": lambda: zlib.decompress(b"x"),
    "lzma": lambda: lzma.decompress(b"x"),
    "struct": lambda: struct.unpack("<f", b"x"),
    "zip": lambda: zipfile.ZipFile(__file__),
    "a name too long": lambda: Path("a" * 5000).read_bytes(),
}
FAULTS: dict[str, Callable[[], object]] = {
    "type": lambda: len(3),  # type: ignore[arg-type]
    "attribute": lambda: (3).size,  # type: ignore[attr-defined]
    "pipe": lambda: (_ for _ in ()).throw(BrokenPipeError),
    "runtime": lambda: (_ for _ in ()).throw(RuntimeError),
    "time": lambda: (_ for _ in ()).throw(TimeLimitReached),
}


@pytest.mark.parametrize("name", DAMAGED)
def test_damaged_data_is_a_sentence_with_the_reason(name: str) -> None:
    with (
        pytest.raises(InputError, match=r"^a\.x: the file is damaged: .{4,160}; export it anew$"),
        reader_guard("a.x"),
    ):
        DAMAGED[name]()


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_of_kilter_stays_a_fault(name: str) -> None:
    faults = (TypeError, AttributeError, RuntimeError, OSError, TimeLimitReached)
    with pytest.raises(faults), reader_guard("a.x"):
        FAULTS[name]()


def test_a_reader_names_further_exceptions_and_its_own_errors_keep_their_words() -> None:
    with (
        pytest.raises(InputError, match="damaged: out of rooms"),
        reader_guard("a.x", also=("builtins.RuntimeError",)),
    ):
        raise RuntimeError("out of rooms.")
    own = pytest.raises(InputError, match=r"^a\.x: part 'b': its mass is -1$")
    with own, reader_guard("a.x"):
        raise InputError("its mass is -1", part="b")
