"""Verify the second-order proof of a proof file, without a solver.

Clusters, features, forms, free motions and separations are computed from the assembly. Only forces,
motions, weights and places are taken from the file, after its form has been verified.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from kilter.arrays import Array, Mask, counted
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.contact.open_pairs import still_open
from kilter.mechanics.clusters import Cluster, clusters
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.proof_form import (
    COUNT,
    SIX,
    WORD,
    every,
    keys,
    list_of,
    named,
    nullable,
    optional_keys,
)
from kilter.mechanics.rows import CONTACT, OF_JOINTS, POSSIBLE
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.joint_forms import of_joints, on_joints
from kilter.second_order.gaps.stationary import stationary
from kilter.second_order.motions.free_motions import FreeMotions, moving_free, scaled_columns
from kilter.second_order.motions.rolling import rolling_of, worst_rolling
from kilter.second_order.motions.sharp_points import sharp_points, sharp_pushes, with_sharp
from kilter.second_order.parts.cluster_states import falling_alone, joined_state
from kilter.second_order.parts.rigid_groups import RigidGroups
from kilter.second_order.proofs.cluster_facts import ClusterFacts
from kilter.second_order.proofs.fall_proof import Fall
from kilter.second_order.proofs.level_rest import Held, LevelRest
from kilter.second_order.proofs.minimum_proof import (
    MalformedProof,
    MinimumProof,
    counts,
    read_motion,
    stacked,
)
from kilter.second_order.proofs.proof_kinds import KINDS, SecondOrderProof
from kilter.second_order.proofs.stopped import Stopped
from kilter.second_order.second_order_tolerances import ACROSS, AGREE, DROPS, KEEPS

# Contacts, bonds and loads that second order cannot model.


OFF_CENTRE = "second order does not model loads beside a centre of mass"


def unmodelled_pairs(assembly: Assembly, contacts: ContactSet) -> dict[frozenset[int], str]:
    """Pairs of parts with contacts that second order cannot model, each with the reason."""
    if not contacts.open_pairs and not len(contacts.possible):
        return {}
    sharp = sharp_pushes(contacts)
    jointed = RigidGroups.of(assembly).jointed_pairs(assembly)
    possible = _pairs(contacts)
    known = _on_rims(contacts) | _within_groups(assembly, contacts) | sharp
    pushed = {possible[k] for k in np.flatnonzero(sharp)}
    found = {}
    for pair in still_open(contacts.open_pairs, assembly):
        both = frozenset(pair.ends)
        overlaps = pair.kind == "overlap" and both in jointed
        if not (overlaps or (pair.kind == "degenerate" and both in pushed)):
            found[both] = "is open"
    for k in np.flatnonzero(~known):
        if possible[k] not in jointed:
            found.setdefault(possible[k], "is not modelled")
    return found


def why_unmodelled(
    assembly: Assembly, pairs: Mapping[frozenset[int], str], bodies: Mask | None = None
) -> str:
    """Reason why second order cannot model some bodies, with the first pair; empty if it can.

    Arguments: `bodies` (N,): first parts of the rigid groups that count; by default all.
    """
    if not pairs:
        return ""
    first = RigidGroups.of(assembly).first
    mine = [
        (sorted(pair), why)
        for pair, why in pairs.items()
        if bodies is None or bodies[first[list(pair)]].any()
    ]
    if not mine:
        return ""
    (a, b), why = min(mine)
    more = f", and {len(mine) - 1} more" if len(mine) > 1 else ""
    return f"the contact of {assembly.names[a]} and {assembly.names[b]} {why}{more}"


def why_beyond(program: Program, assembly: Assembly) -> str:
    """Reason why second order cannot model a cluster's bonds, straps or loads; else empty."""
    strapped = bool(assembly.straps) and bool(program.clamp.any())
    if strapped or program.pull.any() or program.cohesion.any():
        return "second order does not model bonds and straps"
    if not np.isin(program.kind, (CONTACT, POSSIBLE, *OF_JOINTS)).all():
        return "second order does not model bonds and straps"
    if np.abs(program.applied[program.free, 3:]).max(initial=0.0) > 0:
        return OFF_CENTRE
    return ""


def loads_off_centre(assembly: Assembly, program: Program) -> tuple[Mask, Mask]:
    """Masks of parts with a load off their centre, and of those with an inclined one, (N,)."""
    off, slanted = np.zeros((2, len(program.names)), dtype=bool)
    groups, center = RigidGroups.of(assembly), assembly.geometry.center
    for load in assembly.loads:
        part = assembly.index_of(load.part)
        first = groups.first[part]
        arm = (center[part] if load.point is None else load.point) - program.center[first]
        if np.linalg.norm(arm) > KEEPS * program.radius[first] and load.force.any():
            off[first] = True
            aside = np.linalg.norm(np.cross(load.force, program.down))
            slanted[first] |= aside > KEEPS * np.linalg.norm(load.force)
    return off, slanted


def _pairs(contacts: ContactSet) -> list[frozenset[int]]:
    """The two parts of each possible contact."""
    both = zip(contacts.possible.part_a.tolist(), contacts.possible.part_b.tolist(), strict=True)
    return [frozenset(pair) for pair in both]


def _within_groups(assembly: Assembly, contacts: ContactSet) -> Mask:
    """Mask of possible contacts between parts of the same rigid group, shape (k,)."""
    first = RigidGroups.of(assembly).first
    within: Mask = first[contacts.possible.part_a] == first[contacts.possible.part_b]
    return within


def _on_rims(contacts: ContactSet) -> Mask:
    """Mask of possible contacts that lie in the plane of a flat patch of the same parts, (k,)."""
    possible, count = contacts.possible, len(contacts.assembly.parts)
    flat = np.flatnonzero(contacts.patch_kind == "plane")
    parts = contacts.patch_parts[flat]
    pair = parts[:, 0] * count + parts[:, 1]
    order = np.argsort(pair, kind="stable")
    flat, pair = flat[order], pair[order]
    wanted = possible.part_a * count + possible.part_b
    first, last = np.searchsorted(pair, wanted, "left"), np.searchsorted(pair, wanted, "right")
    row, place = counted(last - first)
    patch = flat[first[row] + place]
    normal = contacts.patch_normal[patch]
    agrees = np.einsum("ij,ij->i", normal, possible.normals[row]) > 1 - AGREE
    off = possible.points[row] - contacts.points[contacts.patch_start[patch]]
    near = np.abs(np.einsum("ij,ij->i", normal, off)) <= contacts.gap
    on = np.zeros(len(possible), dtype=bool)
    on[row[agrees & near]] = True
    return on & ~possible.two_sided


ENTRY = every(
    keys(state=WORD),
    optional_keys(
        neutral=COUNT,
        free=COUNT,
        rolling=WORD,
        idle=list_of(COUNT),
        motion=named(SIX),
        alone=list_of(WORD),
    ),
)
"""Form of the proof of a cluster, in addition to that of its kind."""
JOINED = every(
    keys(state=WORD, clusters=list_of(nullable(keys()))),
    optional_keys(neutral=COUNT, free=COUNT, rolling=WORD),
)
"""Form of the proof of several clusters; an open cluster has none."""


def recheck_second_order(
    assembly: Assembly, contacts: ContactSet, program: Program, data: Any
) -> list[str]:
    """Reasons why the second-order proof in a proof file is not valid; empty if it is."""
    try:
        if not (isinstance(data, dict) and "clusters" in data):
            _kind_of(data)
        elif fault := JOINED(data, ""):
            raise MalformedProof(fault)
        for entry in _entries(data):
            _kind_of(entry)
        return _wrong(assembly, contacts, program, data)
    except MalformedProof as fault:
        return [f"its second-order data do not have the required form ({fault})"]


def _entries(data: dict[str, Any]) -> list[dict[str, Any]]:
    """Proofs of the single clusters in the data, without clusters whose answer is open."""
    return [entry for entry in data.get("clusters", [data]) if entry is not None]


def _kind_of(entry: Any) -> type[SecondOrderProof]:
    """Class of a cluster's proof, by its key; raises if the data do not have its form.

    Raises `MalformedProof` if the entry has no known kind, or not its form.
    """
    fault = ENTRY(entry, "")
    kind = None if fault else next((KINDS[key] for key in KINDS if key in entry), None)
    if kind is None:
        raise MalformedProof(fault or "it is not a proof of a known kind")
    if fault := kind.FORM(entry, ""):
        raise MalformedProof(fault)
    return kind


def _wrong(
    assembly: Assembly, contacts: ContactSet, program: Program, data: dict[str, Any]
) -> list[str]:
    """Reasons why a second-order proof of valid form fails; empty if it is valid."""
    for entry in (data, *_entries(data)):
        if "rolling" in entry and entry["state"] != "balanced":
            return ["only a balanced cluster can roll"]
    program = RigidGroups.of(assembly).merged(with_sharp(program, contacts), assembly)
    parted = clusters(program)
    if "clusters" not in data and _kind_of(data) in (Held, LevelRest):
        # these kinds may prove any number of clusters at once
        parted = [Cluster(program, np.arange(len(program.kind)))]
    unmodelled = unmodelled_pairs(assembly, contacts)
    entries = data.get("clusters", [data])
    if len(entries) != len(parted):
        return ["its second order does not have a proof for each cluster"]
    whole = ClusterFacts(
        assembly, contacts, program, lambda: features_of(program, contacts, recognised=True)
    )
    loads = loads_off_centre(assembly, program)
    words = []
    for cluster, entry in zip(parted, entries, strict=True):
        if entry is not None:
            word = why_unmodelled(assembly, unmodelled, cluster.program.free)
            facts = _falling_alone(whole.of_cluster(cluster), entry)
            words.append(word or _wrong_entry(facts, entry, *loads))
    reasons = [f"its second order: {word}" for word in words if word]
    if "clusters" in data and not reasons:
        reasons += _wrong_joined(data)
    if not reasons and any("rolling" in entry for entry in (data, *_entries(data))):
        reasons += _wrong_rolling(assembly, contacts, data, entries)
    return reasons


def _falling_alone(facts: ClusterFacts, entry: dict[str, Any]) -> ClusterFacts:
    """Facts of a cluster in which only the parts that fall alone are free, if the entry names them.

    Held parts only take motions away, so a fall beside them is a fall of the cluster.
    """
    if "alone" not in entry:
        return facts
    alone = falling_alone(facts.program, entry["alone"])
    if alone is None:
        raise MalformedProof("the parts that fall alone are not parts that touch one another")
    return facts.of_cluster(alone)


def _wrong_entry(facts: ClusterFacts, entry: dict[str, Any], off: Mask, slanted: Mask) -> str:
    """Reason why the proof of a cluster fails; empty if it is valid.

    Arguments: `off`, `slanted` (N,): parts with a load off their centre of mass, and with an
    inclined such load.
    """
    kind, program = _kind_of(entry), facts.program
    if "alone" in entry and kind is not Fall:
        return "only a fall is proved with other parts held"
    word = why_beyond(program, facts.assembly)
    counted = slanted if kind is LevelRest else off
    if not word and kind is not Held and counted[program.free].any():
        word = OFF_CENTRE
    if word:
        return word
    if entry.get("idle") is not None:
        return _wrong_without_idle(facts, entry)
    return _wrong_proof(facts, entry)


def _wrong_proof(facts: ClusterFacts, entry: dict[str, Any]) -> str:
    """Reason why a proof about all contacts of a cluster fails; empty if it is valid."""
    kind = _kind_of(entry)
    if kind in (LevelRest, Stopped) and of_joints(facts.program).any():
        return "it does not model joints"
    if word := _wrong_surfaces(kind.SURFACES, facts):
        return word
    judged = kind.from_data(facts, entry).judge(facts)
    if isinstance(judged, str):
        return judged
    claimed = (entry["state"], entry.get("neutral"), entry.get("free"))
    return "" if claimed == judged else "its stated result or counts differ from those of its proof"


def _wrong_surfaces(surfaces: str, facts: ClusterFacts) -> str:
    """Reason why the surfaces are too uncertain for a kind of proof; empty if they are not."""
    if surfaces == "none":
        return ""
    if surfaces == "all":
        facts = facts.certain
    elif (facts.program.kind == POSSIBLE).any():
        return "edges and corners without a unique normal are not left out"
    known = bool(facts.known.all())
    if facts.features.doubted and not (known and surfaces != "exact"):
        return "its surfaces are not known exactly enough"
    return "" if known or surfaces != "all" else "the curvature is not known at every contact"


def _wrong_without_idle(facts: ClusterFacts, entry: dict[str, Any]) -> str:
    """Reason why a proof that leaves out contacts without force fails; empty if it is valid.

    Fewer contacts only admit more motions, so a minimum stays a minimum with them. A free state
    stays free with them if a free motion opens them all.
    """
    program, contacts = facts.program, facts.contacts
    kept = np.ones(len(program.part_a), dtype=bool)
    if max(entry["idle"], default=-1) >= len(kept) or min(entry["idle"], default=0) < 0:
        raise MalformedProof("it leaves out contacts that do not exist")
    kept[entry["idle"]] = False
    if on_joints(program)[~kept].any():
        return "joints may not be left out"
    if _kind_of(entry) is not MinimumProof or kept.all():
        return "contacts may be left out only of a proof of a minimum"
    word = _wrong_proof(facts.taking(kept), entry)
    if word or entry["state"] == "minimum":
        return word
    if entry.get("motion") is None:
        raise MalformedProof("its motion is missing")
    problem = stationary(program, np.zeros((len(kept), 12, 12)))
    motion = read_motion(program, entry["motion"])
    columns = scaled_columns(program, problem, motion[None])[:, 0]
    free, size = stacked(program, problem, entry["across"]), float(np.linalg.norm(columns))
    words = []
    if np.abs(columns - free @ (free.T @ columns)).max(initial=0.0) > ACROSS * size:
        words.append("its motion is not one of its free motions")
    opens = sharp_points(program, contacts).opened(problem.rows @ columns > DROPS * size)
    opens |= _alike(program, motion)
    if not opens[~kept].all() or size == 0:
        words.append("its motion does not open the contacts that are left out")
    if not len(moving_free(facts.assembly, FreeMotions(motion[None], ("level",)))):
        words.append("its motion only spins parts of revolution")
    return "; ".join(words)


def _alike(program: Program, motion: Array) -> Mask:
    """Mask of rows whose two free parts a motion shifts equally, without turns, shape (K,)."""
    a, b, free = program.part_a, program.part_b, program.free
    most = KEEPS * float(np.abs(motion[:, :3]).max())
    shifts = np.abs(motion[a, :3] - motion[b, :3]).max(axis=1)
    turns = np.abs(motion[:, 3:]).max(axis=1) * program.radius
    return np.asarray(
        free[a] & free[b] & (shifts <= most) & (np.maximum(turns[a], turns[b]) <= most)
    )


def _wrong_joined(data: dict[str, Any]) -> list[str]:
    """Objection if the stated state or counts of an assembly do not follow from its clusters."""
    given = _entries(data)
    states = [entry["state"] for entry in given]
    states += ["open"] * (len(data["clusters"]) - len(given))
    claimed = {key: data[key] for key in ("neutral", "free") if key in data}
    agrees = data["state"] == joined_state(states) and claimed == counts(given)
    return [] if agrees else ["its stated result or counts differ from those of its clusters"]


def _wrong_rolling(
    assembly: Assembly, contacts: ContactSet, data: dict[str, Any], entries: list[Any]
) -> list[str]:
    """Objection if the stated result about rolling differs from the recomputed result."""
    program = with_sharp(build_program(assembly, contacts), contacts)
    program = RigidGroups.of(assembly).merged(program, assembly)
    parted, features = clusters(program), features_of(program, contacts)
    states = []
    for cluster, entry in zip(parted, entries, strict=True):
        if entry is not None and entry["state"] == "balanced":
            states.append(rolling_of(cluster, features, assembly, entry.get("alone")).state)
            if entry.get("rolling", "open") != states[-1]:
                return ["its claim about rolling is wrong"]
    agrees = worst_rolling(states) == data.get("rolling", "open")
    return [] if agrees else ["its claim about rolling is wrong"]
