"""Every stable orientation of an assembly, or of several at once.

The stable cone (`kilter.analysis.regions.stable_cone`) with the assembly around it: what was found,
in which contacts, what it does not know of, and proofs that a stranger can verify. For
several assemblies the cones are intersected: a plan needs no reorientation where one
direction is stable for every step of it.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kilter.analysis.answers import joints_answer
from kilter.analysis.regions.common_region import common_proofs, intersection
from kilter.analysis.regions.polyhedral_cone import Cone
from kilter.analysis.regions.region_words import further_forces, warnings_of
from kilter.analysis.regions.stable_cone import Proof, StableCone, stable_cone
from kilter.arrays import Array, Mask
from kilter.assembly import Assembly
from kilter.contact import ContactSet, Tolerance, find_contacts
from kilter.errors import InputError
from kilter.mechanics.certificate import ForceProof, MotionProof, check_forces, check_motion
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import make_proof

__all__ = ["Region", "RegionProof", "common_region", "find_region", "region_answer"]

Tell = Callable[[str], None]


@dataclass(frozen=True, slots=True, eq=False)
class RegionProof:
    """A proof about one ray, line, facet or equation of a region.

    Attributes
    ----------
    about : {"ray", "line", "facet", "equation"}
    vector : ndarray, shape (3,)
        The ray, the line or the normal.
    assembly : Assembly
        With gravity along the direction that is proved: the ray, either sign of the line, or
        a direction just outside.
    data : dict
        For `kilter.mechanics.verification.verify_proof`.
    """

    about: str
    vector: Array
    assembly: Assembly
    data: dict[str, Any]


@dataclass(frozen=True, slots=True, eq=False)
class Region:
    """Every stable direction of gravity, in the frame of the assembly.

    Attributes
    ----------
    cone : Cone
        Lines, rays, equations and facets.
    assemblies : tuple of Assembly
        One, or those that share the region.
    contacts : tuple of ContactSet
        Of each.
    found : tuple of StableCone
        The cone of each, with certificates.
    programs : int
        How many linear programs were solved.
    warnings : tuple of str
    seconds : dict
        Of each stage.
    """

    cone: Cone
    assemblies: tuple[Assembly, ...]
    contacts: tuple[ContactSet, ...]
    found: tuple[StableCone, ...]
    programs: int
    warnings: tuple[str, ...]
    seconds: dict[str, float]

    @property
    def kind(self) -> str:
        """One of the ten kinds."""
        return self.cone.kind

    @property
    def dimension(self) -> int:
        """Of the span, 0 to 3."""
        return self.cone.dimension

    @property
    def lines(self) -> Array:
        """Directions both of whose signs are stable: an orthonormal basis, shape (l, 3)."""
        return self.cone.lines

    @property
    def rays(self) -> Array:
        """Extreme rays, unit, orthogonal to the lines, shape (r, 3)."""
        return self.cone.rays

    @property
    def equations(self) -> Array:
        """Orthonormal normals of the span, shape (e, 3)."""
        return self.cone.equations

    @property
    def facets(self) -> Array:
        """Unit inward normals within the span, shape (f, 3)."""
        return self.cone.facets

    @property
    def half_angle_deg(self) -> float | None:
        """Half angle of the widest circular cone inside, within the span [deg]."""
        return self.cone.half_angle_deg

    @property
    def exact(self) -> bool:
        """Whether this is all of it.

        False where friction, or contacts that are not modelled, could make it larger; then
        every direction in it is stable, and more may be.
        """
        return not any(further_forces(contacts) for contacts in self.contacts)

    @property
    def center(self) -> Array | None:
        """The recommended direction: the axis of the widest circular cone inside; or None."""
        return self.cone.center

    @property
    def proved(self) -> bool:
        """Whether every ray, line, facet and equation has a proof that holds."""
        return all(found.proved for found in self.found)

    def contains(self, directions: ArrayLike, margin: float = 0.0) -> Mask:
        """Whether directions of gravity, shape (..., 3), are stable; see `Cone.contains`.

        Parameters
        ----------
        directions : array_like, shape (..., 3)
        margin : float
            How far inside they must be, within the span [rad].
        """
        return self.cone.contains(directions, margin)

    def proofs(self, *, options: dict[str, Any] | None = None) -> list[RegionProof]:
        """A proof for every ray, line, facet and equation, as data.

        Facets and equations are left out where friction, or contacts that are not modelled,
        might hold what lies beyond them. For several assemblies a ray has a proof in each, a
        facet in the first that does not hold beyond it.
        """
        certified = self._common() if len(self.assemblies) > 1 else self._own()
        proofs = []
        for proof, k in certified:
            turned, contacts = self.assemblies[k].with_down(proof.down), self.contacts[k]
            certificate = _certified(turned, contacts, proof)
            if certificate.holds:
                program = build_program(turned, contacts).frictionless
                data = make_proof(turned, contacts, program, certificate, options or {})
                proofs.append(RegionProof(proof.about, proof.vector, turned, data))
        return proofs

    def _own(self) -> list[tuple[Proof, int]]:
        return [(proof, 0) for proof in self.found[0].proofs]

    def _common(self) -> list[tuple[Proof, int]]:
        return common_proofs(self.cone, self.assemblies, self.contacts)

    def to_dict(self) -> dict[str, Any]:
        """The answer as JSON data."""
        return region_answer(self)

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        from kilter.tell.notebook import region_html

        return region_html(self)

    def __str__(self) -> str:
        half = self.cone.half_angle_deg
        width = "" if half is None else f", half angle {half:.6g} deg"
        return f"{self.kind}{width}"


def _certified(turned: Assembly, contacts: ContactSet, proof: Proof) -> ForceProof | MotionProof:
    """A certificate judged again, on the program that a stranger will build."""
    if isinstance(proof.certificate, ForceProof):
        return check_forces(build_program(turned, contacts).frictionless, proof.certificate.forces)
    outer = build_program(turned, contacts, possible=True, sticking=True).frictionless
    return check_motion(outer, proof.certificate.motion)


def find_region(
    assembly: Assembly,
    contacts: ContactSet | None = None,
    *,
    tolerance: Tolerance | None = None,
    progress: Tell | None = None,
) -> Region:
    """Every direction of gravity for which the assembly stays together, without friction.

    Parameters
    ----------
    assembly : Assembly
        At least one part must be held.
    contacts : ContactSet, optional
        Found from the geometry where not given.
    tolerance : Tolerance, optional
        When faces count as touching.
    progress : callable, optional
        Called with a word at each stage.

    Raises
    ------
    InputError
        If nothing is held, loads are given, or the geometry is not usable.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> region = find_region(scene("paper-figure-10"))
    >>> print(region)
    fan, half angle 45 deg
    >>> region.contains([[-1, 0, -1], [0, 0, 1]])
    array([ True, False])
    """
    assembly.require_grounded()
    started = time.perf_counter()
    if contacts is None:
        contacts = find_contacts(assembly, tolerance=tolerance, progress=progress)
    program = build_program(assembly, contacts).frictionless
    between = time.perf_counter()
    found = stable_cone(program, progress=progress)
    seconds = {"contacts": between - started, "solve": time.perf_counter() - between}
    warnings = warnings_of(assembly, contacts, program, found)
    return Region(
        found.cone, (assembly,), (contacts,), (found,), found.programs, tuple(warnings), seconds
    )


def common_region(
    assemblies: Sequence[Assembly],
    contacts: Sequence[ContactSet] | None = None,
    *,
    tolerance: Tolerance | None = None,
    progress: Tell | None = None,
) -> Region:
    """Every direction of gravity that is stable for all of a list of assemblies.

    Parameters
    ----------
    assemblies : sequence of Assembly
        In one common frame.
    contacts : sequence of ContactSet, optional
        Of each assembly.
    tolerance, progress
        As of `find_region`.

    Raises
    ------
    InputError
        If the list is empty, or as `find_region` does.

    Examples
    --------
    >>> from kilter.scenes.rails import railed
    >>> common_region([railed("-x +x -z"), railed("-x -z +z")]).kind
    'fan'
    """
    if not assemblies:
        raise InputError("no assembly is given", hint="give at least one")
    given = list(contacts) if contacts is not None else [None for _ in assemblies]
    regions = [
        find_region(assembly, own, tolerance=tolerance, progress=progress)
        for assembly, own in zip(assemblies, given, strict=True)
    ]
    started = time.perf_counter()
    cone, programs = intersection([region.cone for region in regions], assemblies[0].down)
    seconds = {key: sum(region.seconds[key] for region in regions) for key in regions[0].seconds}
    seconds["solve"] += time.perf_counter() - started
    return Region(
        cone,
        tuple(region.assemblies[0] for region in regions),
        tuple(region.contacts[0] for region in regions),
        tuple(region.found[0] for region in regions),
        programs + sum(region.programs for region in regions),
        tuple(_common_warnings(cone, regions)),
        seconds,
    )


def _common_warnings(cone: Cone, regions: Sequence[Region]) -> list[str]:
    """Warnings of each, and that nothing is left."""
    warnings = [
        f"{region.assemblies[0].source or f'assembly {k + 1}'}: {text}"
        for k, region in enumerate(regions)
        for text in region.warnings
    ]
    if cone.kind == "none" and all(region.kind != "none" for region in regions):
        warnings.append("no direction is stable for all of them, though each has one of its own")
    return warnings


def region_answer(region: Region) -> dict[str, Any]:
    """The answer of `kilter region --json`.

    Examples
    --------
    >>> from kilter.scenes.rails import railed
    >>> answer = region_answer(find_region(railed("-z")))
    >>> answer["kind"], answer["rays"], answer["half_angle_deg"]
    ('ray', [[0.0, 0.0, -1.0]], 0.0)
    """
    cone = region.cone
    center = cone.center
    return {
        "kind": cone.kind,
        "dimension": cone.dimension,
        "lines": cone.lines.tolist(),
        "rays": cone.rays.tolist(),
        "equations": cone.equations.tolist(),
        "facets": cone.facets.tolist(),
        "center": None if center is None else (center + 0.0).tolist(),
        "half_angle_deg": cone.half_angle_deg,
        "programs": region.programs,
        "exact": region.exact,
        "joints": joints_answer(region.assemblies[0]),
        "gap_deg": None,
        "proved": region.proved,
        "accuracy_deg": float(np.degrees(cone.blur)),
        "warnings": list(region.warnings),
        "seconds": {key: round(value, 6) for key, value in region.seconds.items()},
    }
