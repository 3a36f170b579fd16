"""Rules of an order of assembly, read from its proof file: holds, precedence, groups, threads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.analysis.planning.order.screws import find_screws
from kilter.assembly import Assembly
from kilter.contact import ContactSet

__all__ = ["Rules"]

AXIS = 1e-9
"""Largest sine of the angle between a path along a thread and its axis [-]."""


@dataclass(frozen=True, slots=True)
class Rules:
    """Rules that an order of assembly must keep."""

    hold: int
    """Largest number of parts held at once."""
    precedence: list[tuple[str, str]]
    groups: list[set[str]]
    """Parts that move together."""
    never_held: set[str]
    threads: dict[tuple[str, str], tuple[float, float, float]]
    """Axis of the thread (unit), detected again, by the names of bolt and nut."""

    @classmethod
    def of(cls, assembly: Assembly, contacts: ContactSet, data: Mapping[str, Any]) -> Rules:
        """Read the rules of an order from the data of a proof file.

        Raises `InputError` if a name matches no part, or no thread joins a bolt and its nut.
        """
        screws = [(bolt, nut) for bolt, nut, _ in data["screws"]]
        names = assembly.names
        threads = find_screws(contacts, screws)
        axes = {(names[screw.bolt], names[screw.nut]): screw.axis for screw in threads}
        return cls(
            int(data["hold"]),
            [(first, second) for first, second in data["precedence"]],
            [set(group) for group in data["groups"]],
            set(data["never_held"]),
            {pair: axes[pair] for pair in screws},
        )

    def broken(self, step: Mapping[str, Any], standing: set[str]) -> Iterator[str]:
        """Yield the rules that a step breaks if it follows after the standing parts."""
        parts, held = set(step["parts"]), step["change"]["held"]
        present = standing | parts
        if len(held) > self.hold or len(set(held)) < len(held):
            yield f"{len(held)} parts are held, more than {self.hold}"
        for name in held:
            if name in self.never_held or name not in standing:
                yield f"{name!r} is held, but must not be held"
        for first, second in self.precedence:
            if second in parts and first not in present:
                yield f"{second!r} is inserted before {first!r}"
        for group in self.groups:
            if parts & group and not group <= parts:
                yield f"{min(group - parts)!r} does not move with its group"
        for bolt, nut in self.threads:
            if bolt in parts and nut in standing:
                yield f"the nut {nut!r} is inserted before its bolt {bolt!r}"
        yield from self._thread(parts, step["over"], step["legs"], standing)

    def _thread(
        self, parts: set[str], over: str | None, legs: Any, standing: set[str]
    ) -> Iterator[str]:
        """Yield the reasons why a nut does not move along the thread that its step names."""
        on = [bolt for bolt, nut in self.threads if nut in parts and bolt in standing]
        if over is None and not on:
            return
        nut = min(parts)
        if over not in on or len(parts) > 1:
            yield f"{nut!r} moves along {over!r}, which is not its bolt or not in place"
            return
        axis = np.array(self.threads[over, nut])
        if len(legs) != 1 or np.linalg.norm(np.cross(axis, legs[0][0])) > AXIS:
            yield f"{nut!r} does not move along the axis of its thread"
