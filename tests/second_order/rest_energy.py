"""Random assemblies at rest: their states agree with a descent of the energy.

The energy is lowered from random places near by within a box, by
linear programs over planes that separate the bodies. A place counts if the bodies are exactly apart
there. No place may be lower than a minimum or a free state; the place of a balanced answer must be
lower.
"""

import numpy as np
from scipy.optimize import linprog

import kilter
from kilter.arrays import Array
from kilter.mechanics.program import Program, build_program
from kilter.second_order.answer.second_order_answer import SecondOrder
from kilter.second_order.parts.parting_planes import PartingPlanes, PartPlaces
from kilter.second_order.parts.separation import least_separation

RADII = (0.02, 0.005)
"""Half sizes of the boxes, over the size of the smallest part [-]."""
STARTS, STEPS = 3, 10
"""Number of random places in a box, and of linear programs from each."""
LOWER = 1e-4
"""Energy by which a place is lower, over the weight and the squared box over the size [-]."""
ROUNDING = 1e-14
"""Rounding of a separation, over the size [-]."""


class Descent:
    """The energy of an assembly near its configuration."""

    def __init__(self, assembly: kilter.Assembly, program: Program) -> None:
        self.assembly, self.program = assembly, program
        self.planes = PartingPlanes(assembly, program)
        self.size = float(program.radius[program.free].min())
        self.weight = float(program.weight[program.free].sum())
        six = np.ones((len(program.names), 6))
        six[:, 3:] /= program.radius[:, None]
        self.units = np.where(program.free[:, None], six * self.size, 0.0).reshape(-1)

    def energy(self, place: PartPlaces) -> float:
        """The energy relative to the start, over the weight and the size [-]."""
        return -float((place.shifts * self.program.load[:, :3]).sum()) / (self.weight * self.size)

    def apart(self, place: PartPlaces) -> bool:
        """Whether the bodies are apart, up to the rounding of parts that shift along a plane."""
        found = least_separation(self.assembly, self.program, place.motion, beyond=self.size)
        return found is not None and found >= -ROUNDING * self.size

    def least(self, random: np.random.Generator, t: float) -> float:
        """The least energy found within t of the place with bodies apart; 0 if none was found."""
        count = len(self.units)
        place = PartPlaces.of((t * random.uniform(-1, 1, count) * self.units).reshape(-1, 6))
        best, trust = 0.0, t
        for _ in range(STEPS):
            step = self._solved(place, t, trust)
            if step is None:
                break
            place, trust = place.after((step * self.units).reshape(-1, 6)), trust / 1.5
            if self.apart(place):
                best = min(best, self.energy(place))
        return best

    def _solved(self, place: PartPlaces, t: float, trust: float) -> Array | None:
        """The step in the box that loses most energy; if none is apart, the least violated step."""
        count = len(self.units)
        rows, bound = self.planes.rows(
            place, np.full(len(self.program.names), 8 * t * self.size), 1e-9 * self.size
        )
        now = np.divide(
            place.motion.reshape(-1), self.units, where=self.units > 0, out=np.zeros(count)
        )
        low, high = np.maximum(-trust, -t - now), np.minimum(trust, t - now)
        low, high = np.minimum(low, 0.0), np.maximum(high, 0.0)
        scale = np.append(self.units, np.full(rows.shape[1] - count, self.size))
        scale[count:] = np.where(np.arange(rows.shape[1] - count) % 3 < 2, 1.0, self.size)
        matrix = np.hstack([rows * scale / self.size, -np.ones((len(rows), 1))])
        load = self.program.load.reshape(-1) * self.units / (self.weight * self.size)
        cost = np.concatenate([-load, np.zeros(rows.shape[1] - count), [1e3]])
        box = [
            *zip(low, high, strict=True),
            *([(-1.0, 1.0)] * (rows.shape[1] - count)),
            (0.0, None),
        ]
        found = linprog(cost, matrix, bound / self.size, bounds=box)
        return np.asarray(found.x[:count]) if found.status == 0 else None


def least_beside(assembly: kilter.Assembly, seed: int, t: float) -> float:
    """The least energy within t of the place, over t^2."""
    program = build_program(assembly, kilter.contacts(assembly)).frictionless
    descent, random = Descent(assembly, program), np.random.default_rng(seed)
    return min(descent.least(random, t) for _ in range(STARTS)) / t**2


def contradicts(assembly: kilter.Assembly, found: SecondOrder, seed: int) -> tuple[str, bool]:
    """The contradiction of a descent to a state, else empty; whether a lower place was found."""
    least = [least_beside(assembly, seed, t) for t in RADII]
    lower = min(least) < -LOWER
    if found.state == "balanced":
        place = found.configuration
        assert found.program is not None
        good = place is not None and Descent(assembly, found.program).apart(
            PartPlaces.of(place.motion)
        )
        good = good and place is not None and place.energy < 0
        return ("" if good else "its place is not lower and apart"), lower
    return (f"{least} t^2 lower" if lower else ""), lower
