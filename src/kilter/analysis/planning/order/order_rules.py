"""What an order of assembly keeps to, read from its proof: holds, precedence, groups, threads."""

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
"""Sine by which a way along a thread may be off its axis."""


@dataclass(frozen=True, slots=True)
class Rules:
    """What an order keeps to.

    Attributes
    ----------
    hold : int
        Most parts held at once.
    precedence : list of pairs of str
    groups : list of sets of str
        Parts that move as one.
    never_held : set of str
    threads : dict
        From the names of a bolt and a nut to the axis of their thread, found anew.
    """

    hold: int
    precedence: list[tuple[str, str]]
    groups: list[set[str]]
    never_held: set[str]
    threads: dict[tuple[str, str], tuple[float, float, float]]

    @classmethod
    def of(cls, assembly: Assembly, contacts: ContactSet, data: Mapping[str, Any]) -> Rules:
        """From the data of a proof file.

        Raises
        ------
        InputError
            If a name matches no part, or no thread joins a bolt and its nut.
        """
        screws = [(bolt, nut) for bolt, nut, _ in data["screws"]]
        names = assembly.names
        found = find_screws(contacts, screws)
        axes = {(names[one.bolt], names[one.nut]): one.axis for one in found}
        return cls(
            int(data["hold"]),
            [(first, second) for first, second in data["precedence"]],
            [set(group) for group in data["groups"]],
            set(data["never_held"]),
            {pair: axes[pair] for pair in screws},
        )

    def broken(self, step: Mapping[str, Any], standing: set[str]) -> Iterator[str]:
        """What putting the parts of a step in beside those that stand breaks."""
        parts, held = set(step["parts"]), step["change"]["held"]
        there = standing | parts
        if len(held) > self.hold or len(set(held)) < len(held):
            yield f"{len(held)} parts are held, more than {self.hold}"
        for name in held:
            if name in self.never_held or name not in standing:
                yield f"{name!r} is held, but must not be held"
        for first, second in self.precedence:
            if second in parts and first not in there:
                yield f"{second!r} is put in before {first!r}"
        for group in self.groups:
            if parts & group and not group <= parts:
                yield f"{min(group - parts)!r} does not move with its group"
        for bolt, nut in self.threads:
            if bolt in parts and nut in standing:
                yield f"the nut {nut!r} is on before its bolt {bolt!r}"
        yield from self._thread(parts, step["over"], step["legs"], standing)

    def _thread(
        self, parts: set[str], over: str | None, legs: Any, standing: set[str]
    ) -> Iterator[str]:
        """Why parts do not come over the thread that they are said to come over."""
        on = [bolt for bolt, nut in self.threads if nut in parts and bolt in standing]
        if over is None and not on:
            return
        nut = min(parts)
        if over not in on or len(parts) > 1:
            yield f"{nut!r} comes over {over!r}, which is not its standing bolt"
            return
        axis = np.array(self.threads[over, nut])
        if len(legs) != 1 or np.linalg.norm(np.cross(axis, legs[0][0])) > AXIS:
            yield f"{nut!r} does not come along the axis of its thread"
