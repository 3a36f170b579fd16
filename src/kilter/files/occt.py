"""OCCT: what it says when it fails, what is inside of a shape, and quiet while it works."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

__all__ = ["asciis", "failures", "inside", "labels", "quiet", "shape_map"]


# the bindings of OCCT 7 and 8 name their containers differently


def shape_map() -> Any:
    """An empty map that numbers shapes."""
    try:
        from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as ShapeMap
    except ModuleNotFoundError:
        from OCP.TopTools import TopTools_IndexedMapOfShape as ShapeMap
    return ShapeMap()


def labels() -> Any:
    """An empty sequence of labels."""
    try:
        from OCP.collections import Sequence_TDF_Label as Labels
    except ModuleNotFoundError:
        from OCP.TDF import TDF_LabelSequence as Labels
    return Labels()


def asciis() -> Any:
    """An empty sequence of words."""
    try:
        from OCP.collections import Sequence_TCollection_AsciiString as Texts
    except ModuleNotFoundError:
        from OCP.TColStd import TColStd_SequenceOfAsciiString as Texts
    return Texts()


def failures(*more: type[Exception]) -> tuple[type[Exception], ...]:
    """What OCCT and its bindings raise over a shape that is not sound; and what is added to it.

    The bindings make each kind of failure a class of its own, without a common base. They refuse
    the null handles and empty boxes that such shapes come with by errors of type, value and run
    time.
    """
    import OCP.Standard

    name = OCP.Standard.__name__.partition(".")[0]
    kinds = [kind for kind in Exception.__subclasses__() if kind.__module__.startswith(name)]
    return (*kinds, RuntimeError, TypeError, ValueError, *more)


@contextmanager
def quiet() -> Iterator[None]:
    """No word of OCCT on the output while this lasts."""
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
    """Shapes of a kind within a shape, not below those of the kind `avoid`."""
    from OCP.TopExp import TopExp_Explorer

    explorer = TopExp_Explorer(shape, kind) if avoid is None else TopExp_Explorer(
        shape, kind, avoid
    )  # fmt: skip
    while explorer.More():
        yield explorer.Current()
        explorer.Next()
