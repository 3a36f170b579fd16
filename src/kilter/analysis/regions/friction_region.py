"""The directions of gravity that friction can hold, with the assembly around them.

What a direction here has is equilibrium: forces in Coulomb's cones that balance every part.
Whether it must stay is asked of one direction at a time (`kilter.analysis.check`).
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.analysis.regions.friction_cone import GAP_DEG, FrictionCone, friction_cone
from kilter.analysis.regions.polyhedral_cone import Cone
from kilter.analysis.regions.region import Region, find_region
from kilter.analysis.remarks import remarks, touching_nothing
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.contact import ContactSet, Tolerance, find_contacts
from kilter.errors import some_names
from kilter.mechanics.program import build_program

__all__ = ["FrictionRegion", "find_region_with_friction"]


@dataclass(frozen=True, slots=True, eq=False)
class FrictionRegion:
    """Every direction of gravity with forces that hold it, enclosed.

    Attributes
    ----------
    found : FrictionCone
    complete : bool
        Whether all contacts are modelled; else directions beyond the facets may be held.
    warnings : tuple of str
    seconds : dict
    """

    found: FrictionCone
    complete: bool
    warnings: tuple[str, ...]
    seconds: dict[str, float]

    @property
    def cone(self) -> Cone:
        """The inner cone: every direction in it is held."""
        return self.found.inner

    @property
    def kind(self) -> str:
        """Of the inner cone."""
        return self.cone.kind

    @property
    def dimension(self) -> int:
        """Of the inner cone, 0 to 3."""
        return self.cone.dimension

    @property
    def lines(self) -> Array:
        """Of the inner cone, shape (l, 3)."""
        return self.cone.lines

    @property
    def rays(self) -> Array:
        """Of the inner cone, shape (r, 3)."""
        return self.cone.rays

    @property
    def equations(self) -> Array:
        """Of the span of the inner cone, shape (e, 3)."""
        return self.cone.equations

    @property
    def facets(self) -> Array:
        """Unit inward normals of the outer cone, shape (f, 3)."""
        return self.found.facets

    @property
    def center(self) -> Array | None:
        """Axis of the widest circular cone inside the inner cone; or None."""
        return self.cone.center

    @property
    def half_angle_deg(self) -> float | None:
        """Half angle of that cone [deg]."""
        return self.cone.half_angle_deg

    @property
    def exact(self) -> bool:
        """Whether rays and facets are of one cone, the true one."""
        return self.found.exact and self.complete

    @property
    def gap_deg(self) -> float | None:
        """How far apart the inner and the outer cone may be [deg]; None where exact."""
        return None if self.found.exact else float(np.degrees(self.found.gap))

    @property
    def programs(self) -> int:
        """How many programs were solved."""
        return self.found.programs

    @property
    def proved(self) -> bool:
        """Whether every ray and facet has a proof that holds."""
        forces = all(proof.holds for _, proof in self.found.forces)
        return forces and all(proof.holds for _, proof in self.found.motions)

    @property
    def none(self) -> bool:
        """Whether it is proved that no direction is held."""
        return self.kind == "none" and self.complete and self.found.gap == 0.0 and self.proved

    def to_dict(self) -> dict[str, Any]:
        """The answer of `kilter region --json`."""
        center = self.center
        return {
            "kind": self.kind,
            "dimension": self.dimension,
            "lines": self.lines.tolist(),
            "rays": self.rays.tolist(),
            "equations": self.equations.tolist(),
            "facets": self.facets.tolist(),
            "center": None if center is None else (center + 0.0).tolist(),
            "half_angle_deg": self.half_angle_deg,
            "programs": self.programs,
            "exact": self.exact,
            "gap_deg": self.gap_deg,
            "proved": self.proved,
            "accuracy_deg": float(np.degrees(max(self.cone.blur, self.found.slack))),
            "warnings": list(self.warnings),
            "seconds": {key: round(value, 6) for key, value in self.seconds.items()},
        }

    def __str__(self) -> str:
        half = self.half_angle_deg
        width = "" if half is None else f", half angle {half:.6g} deg"
        return f"{self.kind}{width}, with friction"


def find_region_with_friction(
    assembly: Assembly,
    contacts: ContactSet | None = None,
    *,
    gap_deg: float = GAP_DEG,
    tolerance: Tolerance | None = None,
    progress: Callable[[str], None] | None = None,
) -> Region | FrictionRegion:
    """Every direction of gravity with forces that hold it; where mu = 0, `find_region`.

    Raises
    ------
    InputError
        As `find_region` does.

    Examples
    --------
    >>> from kilter.scenes import stacks
    >>> region = find_region_with_friction(stacks.block_on_slope(0.0, friction=0.5))
    >>> region.exact, round(region.half_angle_deg, 1), region.gap_deg < 0.1
    (False, 26.6, True)
    """
    assembly.require_grounded()
    started = time.perf_counter()
    if contacts is None:
        contacts = find_contacts(assembly, tolerance=tolerance, progress=progress)
    if not (contacts.patch_mu > 0).any():
        return find_region(assembly, contacts, progress=progress)
    program = build_program(assembly, contacts)
    between = time.perf_counter()
    found = friction_cone(program, gap_deg=gap_deg, progress=progress)
    seconds = {"contacts": between - started, "solve": time.perf_counter() - between}
    complete = not contacts.unsupported and not len(contacts.possible)
    warnings = _warnings(assembly, contacts, found, gap_deg, complete)
    return FrictionRegion(found, complete, tuple(warnings), seconds)


def _warnings(
    assembly: Assembly, contacts: ContactSet, found: FrictionCone, gap_deg: float, complete: bool
) -> list[str]:
    warnings = list(remarks(assembly, contacts))
    alone = touching_nothing(assembly, contacts)
    if alone:
        warnings.append(
            f"touches nothing, so it falls whatever the orientation: {some_names(alone)}"
        )
    if not complete:
        warnings.append(
            "contacts of a kind that is not modelled yet are left out: every direction found is"
            " held, and more may be"
        )
    if found.gap > np.radians(gap_deg):
        warnings.append(
            f"the inner and the outer cone are up to {np.degrees(found.gap):.2g} deg apart,"
            f" more than the {gap_deg:g} asked for"
        )
    return warnings
