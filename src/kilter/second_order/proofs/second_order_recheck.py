"""The proof of second order in a proof file, judged again without a solver.

Clusters, features, forms, free motions and separations are found anew; of the file are forces,
motions, weights and places (`second_order_file` has what they are).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from kilter.arrays import Array, Mask
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.rows import CONTACT
from kilter.second_order.gaps.features import Features
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.recognised import bounded, formed_for_all
from kilter.second_order.gaps.stationary import Stationary, problem_of, stationary
from kilter.second_order.gaps.touched_surfaces import planes_of, touched_surfaces
from kilter.second_order.motions.free_motions import FreeMotions, find_free_motions
from kilter.second_order.motions.free_span import free_span, moving_free, scaled_columns
from kilter.second_order.motions.null_space import null_space
from kilter.second_order.motions.rolling import find_rolling, worst_rolling
from kilter.second_order.motions.sharp_points import (
    opens_points,
    sharp_points,
    with_sharp,
)
from kilter.second_order.parts.clusters import clusters, joined_state
from kilter.second_order.parts.rigid_groups import RigidGroups
from kilter.second_order.proofs.configuration import is_on, separation_at
from kilter.second_order.proofs.held import Held, judge_held
from kilter.second_order.proofs.level_rest import LevelRest, judge_level_rest, level_rows
from kilter.second_order.proofs.locked import LockedTurns, faces_of, judge_locked, shifts
from kilter.second_order.proofs.minimum_proof import Leaf, MinimumProof, judge_minimum
from kilter.second_order.proofs.modelled import (
    OFF_CENTRE,
    loads_off_centre,
    why_beyond,
    why_unmodelled,
)
from kilter.second_order.proofs.paths import judge_path
from kilter.second_order.proofs.second_order_file import (
    counts,
    numbers,
    read_columns,
    read_motion,
    square,
    stacked,
)
from kilter.second_order.proofs.stopped import (
    Stopped,
    judge_stopped,
    level_contacts,
    level_motions,
    stop_forms,
)
from kilter.second_order.second_order_tolerances import ACROSS, APART, DROPS, KEEPS

__all__ = ["recheck_second_order"]


def recheck_second_order(
    assembly: Assembly, contacts: ContactSet, program: Program, data: Any
) -> list[str]:
    """Why the proof of second order of a proof file does not hold; empty where it does.

    Parameters
    ----------
    program : Program
        Of these contacts, without friction.
    """
    try:
        return _wrong(assembly, contacts, program, data)
    except (KeyError, IndexError, TypeError, ValueError, OverflowError, AttributeError) as fault:
        return [f"its second order is not of its form ({fault})"]


def _wrong(
    assembly: Assembly, contacts: ContactSet, program: Program, data: dict[str, Any]
) -> list[str]:
    unmodelled = why_unmodelled(assembly, contacts)
    if unmodelled:
        return [f"its second order: {unmodelled}"]
    program = RigidGroups.of(assembly).merged(with_sharp(program, contacts), assembly)
    off, slanted = loads_off_centre(assembly, program)
    entries = data.get("clusters", [data])
    for one in (data, *entries):
        if one is not None and "rolling" in one and one["state"] != "balanced":
            return ["what is not balanced does not roll"]
    if _by_forces(data):
        beyond = _beyond(program, data, off, slanted)
        return beyond or _wrong_forces(contacts, program, data)
    parted = clusters(program)
    if len(entries) != len(parted):
        return ["its second order is not one of each cluster"]
    reasons = []
    features: Features | None = None
    for cluster, entry in zip(parted, entries, strict=True):
        if entry is None:
            continue
        beyond = _beyond(cluster.program, entry, off, slanted)
        if beyond:
            reasons += beyond
        elif _by_forces(entry):
            reasons += _wrong_forces(contacts, cluster.program, entry)
        else:
            features = features or features_of(program, contacts, recognised=True)
            own = features.take(cluster.rows)
            reasons += _wrong_gaps(assembly, contacts, cluster.program, own, entry)
    if "clusters" in data and not reasons:
        reasons += _wrong_joined(data)
    if any("rolling" in one for one in (data, *entries) if one is not None):
        reasons += _wrong_rolling(assembly, contacts, data, entries)
    return reasons


def _beyond(program: Program, data: dict[str, Any], off: Mask, slanted: Mask) -> list[str]:
    """Are its joints, bonds and loads none that it says nothing of?"""
    word = why_beyond(program)
    counted = slanted if "level" in data else off
    if not word and "held" not in data and counted[program.free].any():
        word = OFF_CENTRE
    return [f"its second order: {word}"] if word else []


def _wrong_rolling(
    assembly: Assembly, contacts: ContactSet, data: dict[str, Any], entries: list[Any]
) -> list[str]:
    """Does friction hold what is said to be balanced, or not, as it says?"""
    program = with_sharp(build_program(assembly, contacts), contacts)
    program = RigidGroups.of(assembly).merged(program, assembly)
    parted, features = clusters(program), features_of(program, contacts)
    states = []
    for part, entry in zip(parted, entries, strict=True):
        if entry is not None and entry["state"] == "balanced":
            states.append(find_rolling(part.program, features.take(part.rows)).state)
            if entry.get("rolling", "open") != states[-1]:
                return ["it does not roll as it says"]
    own = worst_rolling(states) == data.get("rolling", "open")
    return [] if own else ["it does not roll as it says"]


def _wrong_joined(data: dict[str, Any]) -> list[str]:
    """Are state and counts those of the clusters?"""
    given = [one for one in data["clusters"] if one is not None]
    states = [one["state"] for one in given] + ["open"] * (len(data["clusters"]) - len(given))
    if data["state"] == "open" or data["state"] != joined_state(states):
        return [f"its state is not {data['state']!r:.20}"]
    own = {key: data[key] for key in ("neutral", "free") if key in data} == counts(given)
    return [] if own else ["its counts of motions are not its own"]


def _by_forces(data: dict[str, Any]) -> bool:
    return "held" in data or "level" in data


def _wrong_forces(contacts: ContactSet, program: Program, data: dict[str, Any]) -> list[str]:
    """Is it held by its forces, or does it stand on level faces, and is the state that?"""
    count = int(program.free.sum())
    if "held" in data:
        certain = program.taking(program.kind == CONTACT)
        word = judge_held(certain, Held(numbers(data["held"])))
        own = ("minimum", 0)
    else:
        forces = numbers(data["level"])
        proof = LevelRest(forces, read_motion(program, data["motion"]))
        level, sharp = level_rows(program, contacts), sharp_points(program, contacts)
        word = judge_level_rest(program, level, proof, sharp)
        own = ("free", count * (1 if program.planar else 3))
    reasons = [f"its second order: {word}"] if word else []
    if (data["state"], data["neutral"], data["free"]) != (*own, own[1]):
        reasons.append("its state or its counts are not those of its forces")
    return reasons


def _wrong_gaps(
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    features: Features,
    data: dict[str, Any],
) -> list[str]:
    if "idle" in data:
        return _wrong_without_idle(assembly, contacts, program, features, data)
    if (program.kind != CONTACT).any():
        if data["state"] != "balanced":
            return ["edges and corners of no one normal are not left out"]
        rows = np.flatnonzero(program.kind == CONTACT)
        part = program.taking(rows)
        reasons = _wrong_gaps(assembly, contacts, part, features.take(rows), data)
        return reasons or _wrong_at_points(contacts, program, data)
    known = formed_for_all(program, features)
    problem = problem_of(program, features)
    if features.doubted and ("locked" in data or "stopped" in data or not known.all()):
        return ["its surfaces are known too roughly"]
    if "locked" in data:
        return _wrong_locked(contacts, program, problem, data)
    if "stopped" in data:
        return _wrong_stopped(assembly, contacts, program, features, problem, data)
    if data["state"] == "balanced":
        if not known.all():
            return ["not every contact has a second order"]
        touched = touched_surfaces(program, features, contacts)
        problem = bounded(program, features, -1.0) if features.doubted else problem
        problem = replace(problem, on_plane=planes_of(touched))
        return _wrong_path(assembly, contacts, program, problem, data, doubted=features.doubted)
    touched = touched_surfaces(program, features, contacts)
    free = find_free_motions(program, features, touched)
    worst = bounded(program, features, 1.0).taking(known) if features.doubted else None
    problem = problem.taking(known)
    proof = _minimum(program, problem, data)
    neutral = proof.basis.shape[1] + proof.free.shape[1]
    word = judge_minimum(problem, proof, worst)
    reasons = [f"its second order: {word}"] if word else []
    if (neutral, proof.free.shape[1]) != (data["neutral"], data["free"]):
        reasons.append("its counts of motions are not its own")
    if not known.all() and proof.free.shape[1]:
        reasons.append("motions count as free past contacts whose second order is not known")
    return reasons + _wrong_free(assembly, program, problem, (free, proof), data["state"])


def _wrong_without_idle(
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    features: Features,
    data: dict[str, Any],
) -> list[str]:
    """Does it stay without its idle contacts, and does what is free open all of them?"""
    kept = np.ones(len(program.part_a), dtype=bool)
    kept[np.asarray(data["idle"], dtype=np.int64)] = False
    rest = {key: value for key, value in data.items() if key not in ("idle", "motion")}
    if "basis" not in rest or rest["state"] not in ("minimum", "free") or kept.all():
        return ["contacts are left out of what is no minimum"]
    part, own = program.taking(kept), features.take(np.flatnonzero(kept))
    reasons = _wrong_gaps(assembly, contacts, part, own, rest)
    if reasons or rest["state"] == "minimum":
        return reasons
    none = np.zeros((len(program.part_a), 12, 12))
    problem = stationary(program, none)
    motion = read_motion(program, data["motion"])
    columns = scaled_columns(program, problem, motion[None])[:, 0]
    free, size = stacked(program, problem, data["across"]), float(np.linalg.norm(columns))
    if np.abs(columns - free @ (free.T @ columns)).max(initial=0.0) > ACROSS * size:
        reasons.append("its motion is none of those that are free")
    opens = sharp_points(program, contacts).opened(problem.rows @ columns > DROPS * size)
    opens |= _alike(program, motion)
    if not opens[~kept].all() or size == 0:
        reasons.append("its motion does not open the contacts that carry nothing")
    if not len(moving_free(assembly, FreeMotions(motion[None], ("level",)))):
        reasons.append("its motion only spins parts of revolution")
    return reasons


def _wrong_at_points(contacts: ContactSet, program: Program, data: dict[str, Any]) -> list[str]:
    """Does its path open edges and corners that have no one normal?"""
    motion = read_motion(program, data["first"])
    if opens_points(program, contacts, motion):
        return []
    return ["its path does not open edges and corners of no one normal"]


def _alike(program: Program, motion: Array) -> Mask:
    """Rows between free parts that a motion only shifts, both alike, shape (K,)."""
    a, b, free = program.part_a, program.part_b, program.free
    most = KEEPS * float(np.abs(motion[:, :3]).max())
    shifts = np.abs(motion[a, :3] - motion[b, :3]).max(axis=1)
    turns = np.abs(motion[:, 3:]).max(axis=1) * program.radius
    return np.asarray(
        free[a] & free[b] & (shifts <= most) & (np.maximum(turns[a], turns[b]) <= most)
    )


def _wrong_locked(
    contacts: ContactSet, program: Program, problem: Stationary, data: dict[str, Any]
) -> list[str]:
    """Does self-stress lock all but shifts, and are state and counts those?"""
    if program.planar:
        return ["its second order: locked is what moves in space"]
    forces, stress = (numbers(data[key]) for key in ("locked", "stress"))
    proof = LockedTurns(forces / problem.weight, stress)
    word = judge_locked(problem, faces_of(program, contacts, problem), proof)
    if word:
        return [f"its second order: {word}"]
    free, across = (one.shape[1] for one in shifts(problem))
    own = ("free", free + across, free)
    given = (data["state"], data["neutral"], data["free"])
    return [] if given == own else ["its state or its counts are not those of its forces"]


def _wrong_stopped(
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    features: Features,
    problem: Stationary,
    data: dict[str, Any],
) -> list[str]:
    """Do stops keep it from where it would fall, and are state and counts those?"""
    forces = numbers(data["stopped"]) / problem.weight
    weights = numbers(data["weights"])
    proof = Stopped(forces, weights, read_columns(program, problem, data["motion"]))
    touched = touched_surfaces(program, features, contacts)
    free = find_free_motions(program, features, touched)
    span = free_span(program, problem, free.symmetries)
    level, motions = level_contacts(program, features, touched), level_motions(program)
    word = judge_stopped(problem, level, motions, span, proof)
    if word:
        return [f"its second order: {word}"]
    forms = stop_forms(problem, level, motions, span, forces)
    own = ("free", forms.neutral, forms.neutral - forms.tilts.shape[1])
    given = (data["state"], data["neutral"], data["free"])
    return [] if given == own else ["its state or its counts are not its own"]


def _wrong_free(
    assembly: Assembly,
    program: Program,
    problem: Stationary,
    motions: tuple[FreeMotions, MinimumProof],
    state: str,
) -> list[str]:
    """Are its free motions free, and is the state theirs?"""
    free, proof = motions
    if proof.basis.shape[1]:
        free = free.symmetries
    span = free_span(program, problem, free)
    missing = null_space(span.T, ACROSS).T @ proof.free if span.shape[1] else proof.free
    if np.abs(missing).max(initial=0.0) > ACROSS:
        return ["a motion that it calls free is not proved to be"]
    moves = bool(proof.free.shape[1]) and len(moving_free(assembly, free)) > 0
    if state != ("free" if moves else "minimum"):
        return [f"its state is not {state!r:.20}"]
    return []


def _wrong_path(
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    problem: Stationary,
    data: dict[str, Any],
    *,
    doubted: bool,
) -> list[str]:
    """Does the path fall, and is the configuration apart and lower?"""
    first, second = (read_columns(program, problem, data[key]) for key in ("first", "second"))
    reasons = ["it counts motions of what falls"] if {"neutral", "free"} & set(data) else []
    size = float(np.linalg.norm(first))
    path = judge_path(problem, first, second)
    if abs(size - 1) > ACROSS or not path.falls:
        reasons.append("its path does not lead down")
    if data["configuration"] is None:
        by_path = doubted or bool((contacts.patch_kind[program.source] == "given").all())
        by_path = by_path and path.one_form
        return reasons if by_path else [*reasons, "it has no configuration that is apart and lower"]
    motion = read_motion(program, data["configuration"])
    columns = scaled_columns(program, problem, motion[None])[:, 0]
    if not is_on(path, columns):
        return [*reasons, "its configuration is not on its path"]
    apart = separation_at(assembly, contacts, program, problem, motion)
    if apart is None or not apart > APART * problem.length:
        reasons.append("its configuration is not apart")
    if not problem.load @ columns > APART:
        reasons.append("its configuration is not lower")
    return reasons


def _minimum(program: Program, problem: Stationary, data: dict[str, Any]) -> MinimumProof:
    leaves = [
        Leaf(numbers(forces) / problem.weight, square(weights))
        for forces, weights in zip(data["forces"], data["weights"], strict=True)
    ]
    basis = stacked(program, problem, data["basis"])
    sides = numbers(data["sides"]).reshape(len(data["sides"]), basis.shape[1])
    splits = tuple(None if one is None else (int(one[0]), int(one[1])) for one in data["splits"])
    if splits and len(splits) < 2 ** (basis.shape[1] - 1):
        raise ValueError("its cones are fewer than the orthants")
    free = stacked(program, problem, data["across"])
    return MinimumProof(basis, sides, free, splits, tuple(leaves))
