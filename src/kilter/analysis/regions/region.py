"""`kilter.region`: every direction of gravity for which one or several assemblies stay together.

The directions of gravity with forces that hold the assembly: without friction those for which
it is stable, found exactly (`kilter.analysis.regions.stable_cone`); with friction those that
forces in Coulomb's cones can hold, between rays inside and facets outside
(`kilter.analysis.regions.cone_cutting`). `kilter.analysis.check` decides whether friction must
hold in a single direction.

For several assemblies the cones are intersected, friction left out: a plan needs no
reorientation if a direction is stable for every step of it.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from kilter.analysis.analysis_tolerances import GAP_DEG
from kilter.analysis.check import given_direction_known
from kilter.analysis.decision.judge import judge
from kilter.analysis.decision.open_question import AnsweredPair, answered_pairs
from kilter.analysis.regions.cone_cutting import friction_cone
from kilter.analysis.regions.cone_oracle import intersection
from kilter.analysis.regions.polyhedral_cone import Cone
from kilter.analysis.regions.region_proofs import (
    RegionProof,
    common_proofs,
    further_forces,
    region_proof,
    warnings_of,
)
from kilter.analysis.regions.stable_cone import StableCone, stable_cone
from kilter.analysis.regions.well import PlaceOfRest, find_rests
from kilter.arrays import Mask
from kilter.assembly import Assembly, Joint, ListedJoint, require_assembly
from kilter.assembly.bonds import NO_CONE, require_no_bonds
from kilter.assembly.question import Question, plain_joints, question
from kilter.contact import ContactSet, Tolerance, detect
from kilter.contact.fits.suggestions import require_apart
from kilter.contact.open_pairs import still_open
from kilter.errors import InputError
from kilter.mechanics.bundle import make_bundle
from kilter.mechanics.certificate import ForceProof
from kilter.mechanics.program import build_program
from kilter.tell.html import InCells
from kilter.tell.record import (
    AnswerInWords,
    InPython,
    LevelWord,
    Lines,
    Record,
    Seconds,
    Vector,
    key,
)
from kilter.tell.region_facts import region_phrase
from kilter.threads import on_one_thread
from kilter.values.guesses import guarded
from kilter.work import stop_after

Tell = Callable[[str], None]
SAME_REGION = 1e-6
"""Angle up to which two regions are the same [rad]; a larger one hides pairs that decide."""
LARGE = 1000
"""Number of contact points above which the region with joined open pairs is not computed if a
single direction proves that these pairs decide, and `kilter.orient` refines a region with friction
only around its widest circular cone."""


class RegionShape(Record):
    """Lines, rays and bounding planes of a region of directions of gravity."""

    cone: InPython[Cone]
    """Lines, rays and equations. With friction in space the inner cone: every direction in it is
    held."""
    facets: Lines
    """Unit inward normals within the span: beyond any of them no forces hold it. Those of the cone,
    or with friction in space of the outer cone."""

    @property
    @key
    def kind(self) -> str:
        """Kind of the region's cone, a word of `polyhedral_cone.KINDS` such as "fan"."""
        return self.cone.kind

    @property
    @key
    def lines(self) -> Lines:
        """Directions that are stable with either sign: an orthonormal basis, shape (l, 3)."""
        return self.cone.lines

    @property
    @key
    def rays(self) -> Lines:
        """Extreme rays of the region, unit, orthogonal to its lines, shape (r, 3)."""
        return self.cone.rays

    @property
    @key
    def equations(self) -> Lines:
        """Orthonormal normals of the planes that contain the region, shape (e, 3)."""
        return self.cone.equations

    @property
    @key
    def half_angle_deg(self) -> float | None:
        """Half angle of the widest circular cone in the region [deg]; None if there is none."""
        return self.cone.half_angle_deg


class Region(InCells, RegionShape, AnswerInWords):
    """Answer of `kilter.region`: all directions of gravity in which the assembly stays.

    The directions are in the frame of the assembly. Without friction (`friction` is False) a
    direction in the region is stable. With friction a direction in it has forces that hold it.
    """

    answer: ClassVar[str] = "region"

    friction: bool
    """Whether forces of friction were counted."""
    complete: bool
    """Whether no force was left out that might hold more: friction, or contacts of a kind that is
    not modelled."""
    assemblies: InPython[tuple[Assembly, ...]]
    """A single assembly, or those that share the region."""
    contacts: InPython[tuple[ContactSet, ...]]
    """Contacts of each assembly."""
    found: InPython[tuple[StableCone, ...]]
    """The cone of each, with certificates."""
    programs: int
    """Number of programs solved."""
    warnings: tuple[str, ...]
    """Warnings about the assembly and its contacts."""
    seconds: Seconds
    """Duration of each stage [s]."""
    rests: tuple[PlaceOfRest, ...] = ()
    """State of rest in its axis, lines and rays, if it was requested."""
    if_joined: RegionShape | None = None
    """The region with the parts of every open pair joined; None without open pairs."""
    joined_holds: InPython[bool] = False
    """In place of `if_joined` for a large assembly: whether it is proved that the given direction,
    which the region excludes, is held with the parts of every open pair joined."""

    @property
    @key
    def assumed(self) -> tuple[str, ...]:
        """Options that are assumed: "floor" or "ground" if the file holds no part, "units"."""
        return tuple(dict.fromkeys(key for each in self.assemblies for key in each.assumed))

    @property
    @key
    def joints(self) -> tuple[ListedJoint, ...]:
        """Joints, with those that fastening added."""
        return self.assemblies[0].joints_data()

    @property
    @key
    def open_pairs(self) -> tuple[AnsweredPair, ...]:
        """Pairs of parts whose contact the geometry does not determine."""
        known = zip(self.assemblies, self.contacts, strict=True)
        return tuple(pair for one, contacts in known for pair in answered_pairs(one, contacts))

    @property
    @key
    def level(self) -> LevelWord:
        """Verdict level of the assembly in each direction of the region, to first order."""
        return "equilibrium" if self.friction else "proved"

    @property
    @key
    def pairs_decide(self) -> bool:
        """Whether the region changes if the parts of pairs with uncertain contact are joined."""
        other = self.if_joined
        if other is None:
            return self.joined_holds
        if other.kind != self.kind:
            return True
        ends = np.concatenate([other.rays, other.lines, -other.lines])
        return not bool(self.contains(ends, -SAME_REGION).all())

    @property
    @key
    def dimension(self) -> int:
        """Dimension of the span of the region, 0 to 3."""
        return self.cone.dimension

    @property
    @key
    def center(self) -> Vector | None:
        """Recommended direction: axis of the widest circular cone in the region; else None."""
        return self.cone.center

    @property
    @key
    def exact(self) -> bool:
        """Whether rays and facets bound the same cone, which is then exactly the stable region.

        If False, every direction in it is still held, and more may be.
        """
        return self.complete and all(part.exact for part in self.found)

    @property
    @key
    def gap_deg(self) -> float | None:
        """Largest angle between inner and outer bound of the region [deg]; None if it is exact."""
        gaps = [part.gap for part in self.found if not part.exact]
        return float(np.degrees(max(gaps))) if gaps else None

    @property
    def none(self) -> bool:
        """Whether it is proved that no direction of gravity holds the assembly."""
        return self.kind == "none" and self.complete and not self.gap_deg and self.proved

    @property
    @key
    def proved(self) -> bool:
        """Whether every ray, line, facet and equation of the region has a proof that holds."""
        return all(part.proved for part in self.found)

    @property
    @key
    def accuracy_deg(self) -> float:
        """Directions closer to the boundary count as on it [deg]."""
        return float(np.degrees(max(self.cone.blur, *(part.slack for part in self.found))))

    def contains(self, directions: ArrayLike, margin: float = 0.0) -> Mask:
        """Whether given directions of gravity are in the region, at least `margin` inside.

        Parameters
        ----------
        directions : array_like, shape (..., 3)
        margin : float
            How far inside they must be, within the span [rad].
        """
        return self.cone.contains(directions, margin)

    def proofs(
        self,
        *,
        about: Iterable[str] = ("ray", "line", "facet", "equation"),
        options: dict[str, Any] | None = None,
    ) -> list[RegionProof]:
        """Proofs of every ray, line, facet and equation of the region, as data.

        `about` limits the proofs to these kinds.

        Facets and equations are left out if forces that were not counted might hold directions
        beyond them. For several assemblies a ray has a proof in each, a facet in the
        first that does not hold beyond it.
        """
        certified = [(proof, 0) for proof in self.found[0].proofs]
        if len(self.assemblies) > 1:
            certified = common_proofs(self.cone, self.assemblies, self.contacts)
        if self.friction and not self.complete:
            certified = [(p, k) for p, k in certified if isinstance(p.certificate, ForceProof)]
        programs = list(map(build_program, self.assemblies, self.contacts))
        kinds = frozenset(about)
        proofs = [
            region_proof(
                proof,
                self.assemblies[k],
                self.contacts[k],
                programs[k],
                friction=self.friction,
                options=options or {},
            )
            for proof, k in certified
            if proof.about in kinds
        ]
        return [proof for proof in proofs if proof is not None]

    def proof(self, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """All proofs of the region in a single bundle for `kilter.verify`, as JSON data.

        Raises
        ------
        InputError
            If there are several assemblies, or no proof.
        """
        if len(self.assemblies) > 1:
            raise InputError(
                "a common region has no single proof, since it is about several files",
                hint="write the proof of each file by itself, or use `proofs`",
            )
        proofs = []
        for entry in self.proofs(options=options):
            about = {"about": entry.about, "vector": entry.vector.tolist()}
            proofs.append((about | {"change": {"down": entry.data["down"]}}, entry.data))
        slack = max(self.cone.blur, *(part.slack for part in self.found))
        gap = slack + max(part.gap for part in self.found)
        # contacts of uncertain normals permit no motion as a proof: then only rays are proved
        closed = self.kind == "all" or any("motion" in data for _, data in proofs)
        return make_bundle("region", proofs, gap_deg=float(np.degrees(gap)) if closed else None)

    def __str__(self) -> str:
        return region_phrase(self.kind, self.half_angle_deg, friction=self.friction)

    def __repr__(self) -> str:
        return f"Region({self})"


@question(lacks="require effort")
def region(
    asked: Question,
    *,
    gap_deg: float = GAP_DEG,
    rests: bool = False,
) -> Region:
    """Find every direction of gravity for which an assembly stays together.

    Parameters
    ----------
    assembly : Assembly, or path
        It has at least one held part.
    gap_deg : float
        How far apart the inner and the outer cone may be, with friction in space [deg].
    rests : bool
        Also which of its axis, lines and rays are strict minima of energy (`Region.rests`).

    Raises
    ------
    TimeLimitReached
        At the time limit, with the verdict of the given direction, if nothing else is known. With
        friction the region that is known by then is returned, with its `gap_deg`.
    InputError
        If nothing is held, loads are given, the geometry is not usable, or `rests` are requested
        of parts that rub.

    See Also
    --------
    kilter.orient : the best direction only.
    kilter.common_region : the directions for which several assemblies hold.

    Examples
    --------
    >>> from kilter.scenes import scene, stacks
    >>> found = region(scene("paper-figure-10"))
    >>> found
    Region(fan, half angle 45 deg)
    >>> found.contains([[-1, 0, -1], [0, 0, 1]])
    array([ True, False])
    >>> rough = region(stacks.block_on_slope(0.0, friction=0.5))
    >>> rough.exact, round(rough.half_angle_deg, 1), rough.gap_deg < 0.1
    (False, 26.5, True)
    """
    return region_of(asked, gap_deg=gap_deg, rests=rests)


def region_of(
    asked: Question, *, gap_deg: float = GAP_DEG, rests: bool = False, widest: bool = False
) -> Region:
    """Find the region as `region`; if `widest`, with friction only its widest circular cone.

    The half angle of that cone is then known to within `gap_deg`, the rest of the region less well.
    """
    assembly = asked.assembly
    require_no_bonds(assembly, "region", NO_CONE)
    assembly.require_grounded()
    started = time.perf_counter()
    contacts = detect.touching(asked)
    rubs = bool((contacts.patch_mu > 0).any())
    if rests and rubs:
        raise InputError(
            "places of rest can be computed only without friction", hint="leave friction out"
        )
    limit = asked.seconds_left
    pairs = still_open(contacts.open_pairs, assembly)
    with given_direction_known(assembly, contacts, limit):
        with stop_after(limit if limit is None or not pairs else limit / 2):
            stable = _region(
                assembly, contacts, rubs, gap_deg, started, asked.progress, widest=widest
            )
        if pairs:
            joined = _all_joined(assembly, contacts)
            if _joined_holds(stable, joined):
                stable = replace(stable, joined_holds=True)
            else:
                now = time.perf_counter()
                other = _region(joined, contacts, rubs, gap_deg, now, asked.progress)
                stable = replace(
                    stable, if_joined=RegionShape(cone=other.cone, facets=other.facets)
                )
        if not rests:
            return stable
        return replace(stable, rests=find_rests(stable.cone, assembly, contacts))


def _all_joined(assembly: Assembly, contacts: ContactSet) -> Assembly:
    """The assembly with the parts of every open pair joined."""
    names, pairs = assembly.names, still_open(contacts.open_pairs, assembly)
    return assembly.with_joints(
        [Joint((names[pair.ends[0]], names[pair.ends[1]])) for pair in pairs]
    )


def _joined_holds(drawn: Region, joined: Assembly) -> bool:
    """Whether forces prove for a large assembly that its open pairs change the region.

    The given direction must be outside the region as drawn, and be held with all pairs joined. This
    costs a single judgement instead of a second region.
    """
    contacts = drawn.contacts[0]
    inside = drawn.kind != "none" and bool(drawn.contains(joined.down[None])[0])
    if inside or len(contacts.points) <= LARGE:
        return False
    program = build_program(joined, contacts)
    return judge(program if drawn.friction else program.frictionless).stable is True


def _region(
    assembly: Assembly,
    contacts: ContactSet,
    rubs: bool,
    gap_deg: float,
    started: float,
    progress: Tell | None,
    *,
    widest: bool = False,
) -> Region:
    """Find the region of a single assembly, with or without friction."""
    require_apart(assembly, contacts)
    program = build_program(assembly, contacts)
    program = program if rubs else program.frictionless
    between = time.perf_counter()
    if rubs:
        cone = friction_cone(program, gap_deg=gap_deg, widest=widest, progress=progress)
    else:
        cone = stable_cone(program, progress=progress)
    seconds = {"contacts": between - started, "solve": time.perf_counter() - between}
    return Region(
        cone=cone.cone,
        facets=cone.facets,
        friction=rubs,
        complete=not further_forces(contacts, rubs),
        assemblies=(assembly,),
        contacts=(contacts,),
        found=(cone,),
        programs=cone.programs,
        warnings=tuple(
            warnings_of(assembly, contacts, program, cone, 180.0 if widest else gap_deg)
        ),
        seconds=seconds,
    )


@guarded
@on_one_thread
def common_region(
    assemblies: Sequence[Assembly],
    *,
    contacts: Sequence[ContactSet] | None = None,
    tolerance: Tolerance | None = None,
    progress: Tell | None = None,
) -> Region:
    """Find every direction of gravity for which all of several assemblies hold.

    Friction is left out: the answer is on the safe side.

    Parameters
    ----------
    assemblies : sequence of Assembly
        Assemblies in a common frame.
    contacts : sequence of ContactSet, optional
        Contacts of each assembly.
    tolerance, progress
        As of `region`.

    Raises
    ------
    InputError
        If the list is empty, or as `region` does.

    See Also
    --------
    kilter.region : the directions of a single assembly.
    kilter.orient : the best direction of a single assembly.

    Examples
    --------
    >>> from kilter.scenes.rails import railed
    >>> common_region([railed("-x +x -z"), railed("-x -z +z")]).kind
    'fan'
    """
    if isinstance(assemblies, Assembly) or not isinstance(assemblies, Sequence):
        raise InputError("common_region wants a list of assemblies", hint="give [one, other, ...]")
    if not assemblies:
        raise InputError("no assembly is given", hint="give a list that is not empty")
    given = list(contacts) if contacts is not None else [None for _ in assemblies]
    regions = []
    for assembly, contact_set in zip(assemblies, given, strict=True):
        require_assembly(assembly, "common_region")
        assembly = plain_joints(assembly, "common_region")
        require_no_bonds(assembly, "common_region", NO_CONE)
        assembly.require_grounded()
        begun = time.perf_counter()
        touching = contact_set or detect.contacts(assembly, tolerance=tolerance, progress=progress)
        regions.append(_region(assembly, touching, False, GAP_DEG, begun, progress))
    started = time.perf_counter()
    cone, programs = intersection([member.cone for member in regions], assemblies[0].down)
    seconds = {key: sum(member.seconds[key] for member in regions) for key in regions[0].seconds}
    seconds["solve"] += time.perf_counter() - started
    return Region(
        cone=cone,
        facets=cone.facets,
        friction=False,
        complete=all(member.complete for member in regions),
        assemblies=tuple(assemblies),
        contacts=tuple(member.contacts[0] for member in regions),
        found=tuple(member.found[0] for member in regions),
        programs=programs + sum(member.programs for member in regions),
        warnings=tuple(_common_warnings(cone, regions)),
        seconds=seconds,
    )


def _common_warnings(cone: Cone, regions: Sequence[Region]) -> list[str]:
    """Warnings of each region, and a warning if no direction is common to all."""
    warnings = [
        f"{member.assemblies[0].source or f'assembly {k + 1}'}: {text}"
        for k, member in enumerate(regions)
        for text in member.warnings
    ]
    if cone.kind == "none" and all(member.kind != "none" for member in regions):
        warnings.append(
            "no direction is stable for all assemblies, although each of them has stable directions"
        )
    return warnings
