"""The programs of an assembly with a part at a place: its weight on a top, or its contacts.

On a single top the forces under the part are equal to its weight at its centre, so its weight acts
on this top. On several tops the part is a part of the program, with contacts at the corners of
its areas of contact.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import shapely

from kilter.analysis.placing.upright_prisms import PlacedPrism, Top
from kilter.arrays import Array
from kilter.contact.common.patches import PossibleContacts
from kilter.mechanics.forms import ScaledProblem, scaled_problem
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT, ForceRows, pushing_rows

__all__ = ["PlacedLoads"]

NEW = "new part"
"""Name of the part that is put down."""


@dataclass(eq=False)
class PlacedLoads:
    """Programs of an assembly with a further part.

    Arguments: `friction`: friction coefficient of the part on the tops [-].
    """

    program: Program
    part: PlacedPrism
    friction: float
    _on_parts: dict[tuple[int, ...], Program] = field(default_factory=dict)

    def on_top(self, top: Top, place: Array) -> tuple[Program, Array]:
        """The program with the weight on a top at a place, and its change per shift, (2, N, 6)."""
        point = np.append(place, top.high)
        weight = self.part.mass * self.program.gravity
        base = np.zeros((len(self.program.names), 6))
        base[top.part, :3] = weight
        base[top.part, 3:] = np.cross(point - self.program.center[top.part], weight)
        loaded = self.program.with_rows(applied=self.program.applied + base)
        return loaded, self._torques(top.part, len(self.program.names))

    def on_areas(
        self, areas: dict[int, shapely.Geometry], height: float, place: Array
    ) -> tuple[Program, Array]:
        """The program with the part at a place and contacts at the corners of fixed areas.

        Also the change of the load per shift of the part, (2, N + 1, 6).
        """
        corners = [shapely.get_coordinates(area)[:-1] for area in areas.values()]
        under = tuple(
            support for support, ring in zip(areas, corners, strict=True) for _ in range(len(ring))
        )
        if under not in self._on_parts:
            self._on_parts[under] = self._with_part(under)
        level = np.concatenate(corners)
        point = np.column_stack([level, np.full(len(level), height)])
        return self._on_parts[under].with_rows(
            point=np.vstack([self.program.point, point]),
            center=np.vstack([self.program.center, [*place, height + self.part.below]]),
        ), self.torques_of_part

    @cached_property
    def alone(self) -> ScaledProblem:
        """Equilibrium with the part and without contacts below it: the first columns of all."""
        return scaled_problem(self._with_part(()))

    def _with_part(self, under: tuple[int, ...]) -> Program:
        """The program with the part and a contact row for each entry; places are not set."""
        program, part = self.program, self.part
        count = len(under)
        pushes = PossibleContacts(
            np.array(under, dtype=np.int64),
            np.full(count, len(program.names)),
            np.zeros((count, 3)),
            np.tile([0.0, 0.0, 1.0], (count, 1)),
            np.zeros(count, dtype=bool),
            np.zeros(count),
            np.full(count, -1),
        )
        rows = pushing_rows(pushes)
        rows = replace(rows, kind=np.full(count, CONTACT), mu=np.full(count, self.friction))
        parts = {
            "names": (*program.names, NEW),
            "free": np.append(program.free, True),
            "center": np.vstack([program.center, np.zeros(3)]),
            "mass": np.append(program.mass, part.mass),
            "inertia": np.concatenate([program.inertia, part.inertia[None]]),
            "radius": np.append(program.radius, part.radius),
            "applied": np.vstack([program.applied, np.zeros(6)]),
            "clamp": np.vstack([program.clamp, np.zeros(6)]),
            "tolerance": np.append(program.tolerance, TOLERANCE),
        }
        joined = ForceRows.join([program.force_rows, rows])
        return program.with_rows(**parts).with_force_rows(joined)

    @cached_property
    def torques_of_part(self) -> Array:
        """Change of the load per shift of the part along x and y, (2, N + 1, 6)."""
        count = len(self.program.names)
        return self._torques(count, count + 1)

    def _torques(self, part: int, count: int) -> Array:
        """Change of the wrench on a part per shift of the weight along x and y, (2, count, 6)."""
        more = np.zeros((2, count, 6))
        for axis in (0, 1):
            more[axis, part, 3:] = np.cross(np.eye(3)[axis], self.part.mass * self.program.gravity)
        return more
