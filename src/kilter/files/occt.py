"""OCCT: what it says when it fails, what is inside of a shape, and quiet while it works."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

__all__ = ["failures", "inside", "quiet"]


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
