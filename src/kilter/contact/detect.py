"""Contact detection: near pairs, flat and curved faces, edges and corners, and overlaps."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import numpy as np

from kilter.arrays import starts
from kilter.assembly import Assembly, Bond, GivenContact
from kilter.assembly.question import Question, question
from kilter.contact.common.contact_search import (
    ContactSearch,
    begin_search,
    given_pairs,
    recent_searches,
)
from kilter.contact.common.distances import nearest_parts
from kilter.contact.common.gaps import RejectedPair, Tolerance, closed_by_clearance, gap_warnings
from kilter.contact.common.patches import Patches, PossibleContacts
from kilter.contact.contact_set import ContactSet
from kilter.contact.contact_tolerances import FIT_PLAY, THREAD
from kilter.contact.curved.coaxial_faces import Fit, coaxial_fits
from kilter.contact.curved.curved_patches import raised_warning
from kilter.contact.curved.rims import rim_contacts
from kilter.contact.flat_contacts import GAP_EDGES
from kilter.contact.friction_coefficients import (
    certain_friction,
    friction_coefficients,
    with_piece_friction,
)
from kilter.contact.open_pairs import OpenPair, find_open_pairs, open_forces
from kilter.contact.pair_findings import PairFindings, examine, examine_in_time
from kilter.contact.smooth.smooth_joints import possible_forces_of, smooth_warning
from kilter.errors import InputError
from kilter.work import facts_of, stop_after, take_at_least

if TYPE_CHECKING:
    from kilter.assembly.array_geometry import SideBySide

LEAST_TIME = 0.2
"""Time in which contacts are searched for whatever the time limit [s]."""


@question(lacks="contacts require effort assume")
def contacts(
    asked: Question,
) -> ContactSet:
    """Find the contacts of an assembly.

    Parameters
    ----------
    assembly : Assembly, or path
    time_limit : float, optional
        Time limit [s]. Near pairs that are not examined until then are open pairs of the kind
        "unexamined". The search takes at least 0.2 s, which suffice for small assemblies.

    Returns
    -------
    ContactSet
        Patches of detected and given contacts, rejected pairs, overlaps and open pairs.

    Raises
    ------
    InputError
        If the tolerance is not above zero.

    See Also
    --------
    kilter.fastened : joints between the touching parts.
    kilter.check : the verdict, which detects contacts itself.

    Examples
    --------
    >>> from kilter.shape.primitives import Box
    >>> from kilter.assembly import Part
    >>> from kilter.rigid import Pose
    >>> table = Part("table", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    >>> result = contacts(Assembly([table, Part("cube", Box([1, 1, 1]), Pose([0, 0, 0.5]))]))
    >>> result
    <ContactSet: patches 1, points 4, pairs 1>
    >>> result.patch_area, result.patch_normal.tolist()
    (array([1.]), [[0.0, 0.0, 1.0]])
    """
    assembly, time_limit = asked.assembly, asked.seconds_left
    tolerance = asked.tolerance or assembly.tolerance or Tolerance()
    if not isinstance(tolerance, Tolerance):
        raise InputError(
            f"the tolerance is {tolerance!r:.60}", hint="give kilter.Tolerance(gap=...)"
        )
    with stop_after(time_limit):
        contact_set = without_neighbours(assembly, tolerance, asked.tell, time_limit)
        report_fact = facts_of(asked.progress)
        if report_fact is not None:
            report_fact("contacts", touching_words(contact_set))
        asked.tell("nearest parts")
        return _with_neighbours(contact_set)


def touching(asked: Question) -> ContactSet:
    """The contacts of a question: those given with it, or those of its assembly."""
    if asked.contacts is None:
        return contacts(asked)
    if not isinstance(asked.contacts, ContactSet):
        raise InputError(
            f"contacts are {asked.contacts!r:.60}", hint="give what kilter.contacts returns"
        )
    return asked.contacts


def without_neighbours(
    assembly: Assembly,
    tolerance: Tolerance,
    report_stage: Callable[[str], None] = lambda stage: None,
    time_limit: float | None = None,
) -> ContactSet:
    """The contacts of an assembly, as `contacts`; the nearest neighbours are left out."""
    tolerance.require_sound()
    search, findings = _search(assembly, tolerance, report_stage, time_limit)
    return _contact_set(assembly, search, findings, tolerance)


def _search(
    assembly: Assembly,
    tolerance: Tolerance,
    report_stage: Callable[[str], None],
    time_limit: float | None,
) -> tuple[ContactSearch, PairFindings]:
    """The search of an assembly and its findings, which may be those of an equal recent search."""
    recent = recent_searches(assembly.geometry)
    conditions = tolerance, assembly.detect, given_pairs(assembly)
    known: tuple[ContactSearch, PairFindings] | None = recent.findings.get(conditions)
    if known is not None:
        return known
    search = begin_search(assembly, tolerance, report_stage).without_same_bodies()
    report_stage(f"contacts of near pairs: {len(search.pairs)}")
    if time_limit is None:
        findings = examine(assembly, search, tolerance)
    else:
        with take_at_least(LEAST_TIME):
            findings = examine_in_time(assembly, search, tolerance)
    if len(findings.search.pairs) == len(search.pairs):
        recent.keep(conditions, (search, findings))
    return search, findings


def contacts_of_findings(
    assembly: Assembly, findings: PairFindings, tolerance: Tolerance
) -> ContactSet:
    """The contacts of an assembly from complete findings about its pairs."""
    return _with_neighbours(_contact_set(assembly, findings.search, findings, tolerance))


def _with_neighbours(contact_set: ContactSet) -> ContactSet:
    """Contacts with the nearest part of each part that touches nothing."""
    alone = contact_set.alone
    if not len(alone):
        return contact_set
    nearest = nearest_parts(contact_set.assembly.geometry, alone)
    return dataclasses.replace(contact_set, neighbours=nearest)


def touching_words(contact_set: ContactSet) -> str:
    """Number of touching pairs of parts as a clause, for instance "3 pairs of parts touch".

    It also states the number of pairs that were not examined.
    """
    pairs, unexamined = contact_set.pairs, contact_set.unexamined
    touching = "1 pair of parts touches" if pairs == 1 else f"{pairs} pairs of parts touch"
    return f"{touching}, {unexamined_words(unexamined)}" if unexamined else touching


def unexamined_words(count: int) -> str:
    """Clause about the number of pairs of parts whose contacts a time limit left unexamined."""
    pairs = "1 pair of parts was" if count == 1 else f"{count} pairs of parts were"
    return f"the contacts of {pairs} not examined"


def contacts_side_by_side(apart: SideBySide, tolerance: Tolerance) -> ContactSet:
    """Contacts of several independent assemblies at once, with common part numbers.

    Nearest neighbours and warnings are left out.

    Raises `InputError` if the tolerance is not above zero.
    """
    tolerance.require_sound()

    def silent(stage: str) -> None:
        return None

    search = begin_search(apart.whole, tolerance, silent, start=apart.start).without_same_bodies()
    findings = examine(apart.whole, search, tolerance)
    return _contact_set(apart.whole, search, findings, tolerance)


def _contact_set(
    assembly: Assembly, search: ContactSearch, findings: PairFindings, tolerance: Tolerance
) -> ContactSet:
    """Convert findings to a contact set; the caller adds the nearest neighbours.

    Pairs of the search without findings become open pairs.
    """
    examined, faces = findings.search, findings.faces
    found = [faces, findings.sharp.patches]
    if assembly.contacts or assembly.bonds:
        found.append(_listed_patches(assembly))
    patches, of_pieces = with_piece_friction(assembly, examined, Patches.join(found))
    unsupported = findings.unsupported
    overlaps = tuple(sorted(findings.overlaps, key=lambda overlap: overlap.ends))
    rejected = sorted([*findings.refused, *findings.near_edges], key=_rank)
    unexamined = search.pairs[len(examined.pairs) :]
    left_open = find_open_pairs(assembly, overlaps, rejected, unsupported, unexamined)
    fits: tuple[Fit, ...] = ()
    if len(search.geometry.surfaces):
        fits = _fits(assembly, examined, tolerance, {frozenset(pair.ends) for pair in overlaps})
    return ContactSet(
        assembly=assembly,
        patch_parts=patches.parts,
        patch_normal=patches.normal,
        patch_area=patches.area,
        patch_gap=patches.gap,
        patch_mu=certain_friction(
            friction_coefficients(assembly, patches.parts, patches.mu), patches.doubt
        ),
        patch_kind=patches.kind,
        patch_accuracy=patches.accuracy,
        patch_doubt=patches.doubt,
        patch_start=patches.start,
        patch_pieces=patches.pieces,
        points=patches.points,
        normals=patches.normals,
        unsupported=unsupported,
        possible=PossibleContacts.join(
            [
                *_possible_forces(assembly, findings),
                of_pieces,
                *([open_forces(left_open, search.geometry)] if left_open else ()),
            ]
        ),
        near=tuple(rejected),
        overlaps=overlaps,
        gap_edges=GAP_EDGES,
        gap_counts=np.bincount(findings.flat.gaps[:, 1], minlength=len(GAP_EDGES) - 1),
        searched=tolerance,
        gap=float(search.limits.gap.max(initial=0.0)),
        notes=tuple(_notes(assembly, findings, rejected, left_open)),
        degenerate=findings.sharp.degenerate,
        open_pairs=left_open,
        fits=fits,
    )


def _notes(
    assembly: Assembly,
    findings: PairFindings,
    rejected: list[RejectedPair],
    left_open: tuple[OpenPair, ...],
) -> Iterator[str]:
    """Yield warnings about the search, the tolerance of gaps, and faces of limited accuracy."""
    limits, raised, joints = findings.search.limits, findings.curved.raised, findings.smooth.joints
    cut = sum(pair.kind == "unexamined" for pair in left_open)
    if cut:
        yield f"the time limit was reached: {unexamined_words(cut)}"
    yield from gap_warnings(findings.flat.patches, rejected, limits)
    if len(raised):
        yield raised_warning(len(raised))
    if joints:
        yield smooth_warning(joints)
    yield from closed_by_clearance(assembly, findings.faces, limits)


def _possible_forces(assembly: Assembly, findings: PairFindings) -> Iterator[PossibleContacts]:
    """Yield forces of contacts that are not modelled, with the friction of their pairs.

    The first rows are the normals of the degenerate points, in order.
    """
    sharp, joints, search = findings.sharp, findings.smooth.joints, findings.search
    possible = [sharp.possible]
    if len(sharp.degenerate):
        possible.insert(0, sharp.degenerate.pushes())
    if len(search.geometry.surfaces):
        rims = rim_contacts(search.geometry, findings.flat.patches)
        possible += [rims, findings.curved.possible]
    forces = PossibleContacts.join(possible)
    if len(forces):
        yield _with_friction(assembly, forces)
    if joints:
        mu = friction_coefficients(assembly, search.pairs, greatest=True)
        yield possible_forces_of(joints, search.pairs, mu)


def _fits(
    assembly: Assembly,
    search: ContactSearch,
    tolerance: Tolerance,
    overlapping: set[frozenset[int]],
) -> tuple[Fit, ...]:
    """Shafts in holes among the near pairs of parts.

    A tight fit counts only if its parts overlap (`overlapping`): otherwise their walls do not meet.
    """
    candidates = coaxial_fits(assembly, search.pairs, tolerance, thickest=THREAD, thinnest=FIT_PLAY)
    return tuple(fit for fit in candidates if not fit.tight or frozenset(fit.ends) in overlapping)


def _rank(rejected: RejectedPair) -> tuple[float, float]:
    """Key by which rejected pairs are sorted: the nearest first."""
    return abs(rejected.gap), rejected.angle


def _listed_patches(assembly: Assembly) -> Patches:
    """Patches for the contacts and the points of bonds that the file lists."""
    bonded = [bond for bond in assembly.bonds if bond.points is not None]
    listed = [contact for contact in assembly.contacts if len(contact.points)]
    given: list[GivenContact | Bond] = [*listed, *bonded]
    parts = np.array([[assembly.index_of(n) for n in c.parts] for c in given], dtype=np.int64)
    normal = np.array([c.normal for c in given]).reshape(-1, 3)
    count = [len(c.points) for c in given]
    none = np.zeros(len(given))
    stated = [contact.mu if isinstance(contact, GivenContact) else None for contact in given]
    return Patches(
        pair=np.full(len(given), -1),
        parts=parts.reshape(-1, 2),
        kind=np.repeat(["given", "bond"], [len(given) - len(bonded), len(bonded)]).astype("<U11"),
        normal=normal,
        area=none,
        gap=np.zeros((len(given), 2)),
        accuracy=none,
        doubt=none,
        mu=np.array(stated, dtype=np.float64),
        start=starts(count),
        points=np.concatenate([np.empty((0, 3)), *(c.points for c in given)]),
        normals=np.repeat(normal, count, axis=0),
    )


def detected_with_friction(detected: ContactSet, mu: float) -> ContactSet:
    """Copy of detected contacts with friction `mu` everywhere, equal to a new detection.

    `detected`: all contacts of an assembly, as `contacts` returns them. `mu`: friction coefficient
    of all pairs [-].
    """
    assembly = detected.assembly.with_friction(mu)
    if friction_needs_detection(detected):
        return contacts(assembly, tolerance=detected.searched)
    possible = detected.possible
    # the last rows are forces of open pairs in any direction, which have no friction
    wrenches = len(open_forces(detected.open_pairs, assembly.geometry))
    rubbing = len(possible) - wrenches
    of_pairs = np.where(np.arange(len(possible)) < rubbing, mu, possible.mu)
    return dataclasses.replace(
        detected,
        assembly=assembly,
        patch_mu=certain_friction(mu, detected.patch_doubt),
        possible=dataclasses.replace(possible, mu=of_pairs),
    )


def friction_needs_detection(detected: ContactSet) -> bool:
    """True if contacts with another friction coefficient cannot be derived from detected contacts.

    Forces beside a fitted normal depend on friction, and listed contacts may have their own.
    """
    return bool(detected.patch_doubt.any() or detected.assembly.contacts)


def _with_friction(assembly: Assembly, possible: PossibleContacts) -> PossibleContacts:
    """Possible contact forces, with the friction coefficient of each pair of parts filled in."""
    parts = np.column_stack([possible.part_a, possible.part_b])
    return dataclasses.replace(possible, mu=friction_coefficients(assembly, parts, greatest=True))
