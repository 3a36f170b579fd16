"""Helpers for OCCT: containers, exception types, silenced output, subshapes of a shape."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

__all__ = ["asciis", "failures", "inside", "labels", "quiet", "shape_map"]


# the bindings of OCCT 7 and 8 name their containers differently


def shape_map() -> Any:
    """An empty OCCT map that numbers shapes and gives equal shapes the same number."""
    try:
        from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as ShapeMap
    except ModuleNotFoundError:
        from OCP.TopTools import TopTools_IndexedMapOfShape as ShapeMap
    return ShapeMap()


def labels() -> Any:
    """An empty OCCT sequence for labels."""
    try:
        from OCP.collections import Sequence_TDF_Label as Labels
    except ModuleNotFoundError:
        from OCP.TDF import TDF_LabelSequence as Labels
    return Labels()


def asciis() -> Any:
    """An empty OCCT sequence for ASCII strings."""
    try:
        from OCP.collections import Sequence_TCollection_AsciiString as Texts
    except ModuleNotFoundError:
        from OCP.TColStd import TColStd_SequenceOfAsciiString as Texts
    return Texts()


def failures(*more: type[Exception]) -> tuple[type[Exception], ...]:
    """Exception types that OCCT raises for an invalid shape, together with the types `more`.

    The bindings define a class for each kind of failure, without a common base. For the null
    handles and empty boxes of invalid shapes they raise TypeError, ValueError or RuntimeError.
    """
    import OCP.Standard

    name = OCP.Standard.__name__.partition(".")[0]
    kinds = [kind for kind in Exception.__subclasses__() if kind.__module__.startswith(name)]
    return (*kinds, RuntimeError, TypeError, ValueError, *more)


@contextmanager
def quiet() -> Iterator[None]:
    """Context manager that silences the output of OCCT."""
    from OCP.Message import Message

    messenger = Message.DefaultMessenger_s()
    printers = list(messenger.Printers())
    for printer in printers:
        messenger.RemovePrinter(printer)
    try:
        yield
    finally:
        for printer in printers:
            messenger.AddPrinter(printer)


def inside(shape: Any, kind: Any, avoid: Any = None) -> Iterator[Any]:
    """Subshapes of type `kind` of a shape, except those inside a subshape of type `avoid`."""
    from OCP.TopExp import TopExp_Explorer

    explorer = TopExp_Explorer(shape, kind) if avoid is None else TopExp_Explorer(
        shape, kind, avoid
    )  # fmt: skip
    while explorer.More():
        yield explorer.Current()
        explorer.Next()
