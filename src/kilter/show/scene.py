"""Data of a report's page: an assembly and the answers about it, as arrays to draw.

Nothing is computed here that an answer does not contain. Motions are arranged by part, forces by
contact point. Positions are float32 relative to `center`, so that an assembly far from the origin
keeps its digits.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.arrays import Array
from kilter.show.colours import assembly_colours
from kilter.show.ladder_card import build_ladder
from kilter.show.movement_scene import build_movement
from kilter.show.packing import pack, readable
from kilter.show.round_patches import round_patches
from kilter.show.shapes import ShapeMesh, place_shapes
from kilter.tell.check_facts import forces_phrase
from kilter.tell.facts import facts
from kilter.tell.region_facts import rest_words
from kilter.tell.second_order_words import second_order_words
from kilter.tell.words import VERDICTS, live_words
from kilter.units import metres_per_unit

if TYPE_CHECKING:
    from kilter.analysis.everything import Answered, Balance, Everything, MapMotions
    from kilter.assembly import Assembly
    from kilter.contact import ContactSet


SAME = 1e-12
"""Distance below which two points count as equal [size of the largest part]."""
SAME_DOWN = 1e-9
"""Distance below which two unit directions count as equal [-]."""
HELD_IN_VIEW = 1.5
"""The first view shows held parts up to this size, relative to the free parts [-]."""


def build_scene(answers: Everything) -> dict[str, Any]:
    """JSON data of the page of an assembly: shapes, and the answers about it."""
    things = build_things(answers.assembly, answers.contacts)
    center = np.array(things["center"])
    return {
        **things,
        "given": build_orientation(answers, answers.given, center)
        | {"assumption": build_ladder(answers.given.check, answers.assembly)},
        **build_directions(answers, center),
        "change": _change(answers, center),
        "movement": None
        if answers.movement is None or not answers.movement.moves
        else build_movement(answers.movement, answers.assembly, center),
        "notes": list(answers.notes),
    }


def build_directions(answers: Everything, center: Array) -> dict[str, Any]:
    """JSON data of the gravity ball: the answers for other directions of gravity.

    Arguments: `center` (3,): point to which positions are relative, world frame [length unit].
    """
    recommended, same = answers.recommended, coincide(answers)
    return {
        "recommended": None
        if recommended is None or same
        else build_orientation(answers, recommended, center),
        "coincide": same,
        "region": _region(answers),
        "rays": _rays(answers, center),
        "map": _map(answers.map),
    }


def coincide(answers: Everything) -> bool:
    """Whether the recommended direction of gravity equals the given direction."""
    best = answers.recommended
    return best is not None and float(np.linalg.norm(best.down - answers.given.down)) < SAME_DOWN


def build_things(assembly: Assembly, contacts: ContactSet) -> dict[str, Any]:
    """JSON data that every page has: shapes, parts, contact patches, open pairs, loads, straps."""
    center, extent = view_box(assembly)
    return {
        "words": VERDICTS,
        "units": assembly.units,
        "planar": assembly.planar,
        "gravity": float(np.linalg.norm(assembly.gravity)),
        "center": center.tolist(),
        "extent": extent.tolist(),
        "radius": float(np.linalg.norm(extent)),
        "shapes": _shapes(assembly),
        "parts": _parts(assembly, center),
        "patches": _patches(contacts, center),
        "open": _open_pairs(contacts, center),
        "loads": [
            {
                "part": assembly.index[load.part],
                "point": None if load.point is None else (load.point - center).tolist(),
                "force": load.force.tolist(),
            }
            for load in assembly.loads
        ],
        "straps": [(strap.points - center).tolist() for strap in assembly.straps],
    }


def view_box(assembly: Assembly) -> tuple[Array, Array]:
    """Middle and half lengths of the box that the page shows at first [length unit].

    The box contains the free parts and the held parts near them. A table extends beyond it.
    """
    geometry = assembly.geometry
    table = np.array([part.table for part in assembly.parts])
    shown = ~table[geometry.vertex_part]
    free = ~geometry.grounded[geometry.vertex_part]
    vertices = geometry.vertices[shown] if shown.any() else geometry.vertices
    wanted = geometry.vertices[free] if free.any() else vertices
    low, high = wanted.min(axis=0), wanted.max(axis=0)
    reach = (HELD_IN_VIEW - 1) * float((high - low).max())
    low = np.maximum(vertices.min(axis=0), low - reach)
    high = np.minimum(vertices.max(axis=0), high + reach)
    return (low + high) / 2, (high - low) / 2


def _shapes(assembly: Assembly) -> list[dict[str, Any]]:
    return [_shape(shape) for shape in place_shapes(assembly).shapes]


def _shape(shape: ShapeMesh) -> dict[str, Any]:
    return {
        "positions": pack(shape.positions),
        "triangles": pack(shape.triangles, "index"),
        "edges": pack(shape.edges, "index"),
    }


def _change(answers: Everything, center: Array) -> dict[str, Any] | None:
    """JSON data of the best change of a brick model: brick to remove, or shape of a new brick.

    None without a change.
    """
    best = answers.change
    if best is None:
        return None
    if best.what == "remove":
        return {"part": answers.assembly.index_of(best.parts[0])}
    places, k = place_shapes(best.changed), best.changed.index_of(best.parts[0])
    at = (places.position[k] - center).tolist()
    return {"part": None, "shape": _shape(places.shapes[places.shape[k]]), "at": at}


def _parts(assembly: Assembly, center: Array) -> dict[str, Any]:
    """JSON data of the parts: names, shapes, poses, masses [kg], volumes, colours, labels."""
    geometry, places = assembly.geometry, place_shapes(assembly)
    return {
        "names": [readable(name) for name in assembly.names],
        "shape": pack(places.shape, "index"),
        "rotation": pack(places.rotation),
        "position": pack(places.position - center),
        "center": pack(geometry.center - center),
        "radius": pack(geometry.radius),
        "mass": pack(geometry.mass, "f8"),
        "volume": pack(geometry.volume, "f8"),
        "grounded": pack(geometry.grounded, "u1"),
        "table": pack(np.array([part.table for part in assembly.parts]), "u1"),
        "colour": pack(assembly_colours(assembly, places.shape), "u1"),
        **_labels(assembly),
    }


def _labels(assembly: Assembly) -> dict[str, list[str | None]]:
    """Materials and layers of the parts, each only if the file states some."""
    columns = {
        "material": [part.material for part in assembly.parts],
        "layer": [part.layer for part in assembly.parts],
    }
    return {key: labels for key, labels in columns.items() if any(labels)}


def _patches(contacts: ContactSet, center: Array) -> dict[str, Any]:
    """JSON data of the contact patches: parts, points, normals, areas, gaps, friction, rings."""
    kinds, kind = np.unique(contacts.patch_kind, return_inverse=True)
    rings = round_patches(contacts)
    widest = np.abs(contacts.patch_gap).argmax(axis=1) if len(contacts) else np.zeros(0, int)
    return {
        "parts": pack(contacts.patch_parts, "index"),
        "start": pack(contacts.patch_start, "index"),
        "points": pack(contacts.points - center),
        "normal": pack(contacts.patch_normal),
        "normals": pack(contacts.normals) if _has_varying_normals(contacts) else None,
        "area": pack(contacts.patch_area, "f8"),
        "gap": pack(contacts.patch_gap[np.arange(len(contacts)), widest], "f8"),
        "mu": pack(contacts.patch_mu, "f8"),
        "round": {
            "points": pack(rings.points - center),
            "patch": pack(rings.patch, "index"),
            "lines": pack(rings.lines, "index"),
            "triangles": pack(rings.triangles, "index"),
        },
        "kinds": [str(word) for word in kinds],
        "kind": pack(kind, "index"),
    }


def _has_varying_normals(contacts: ContactSet) -> bool:
    """Whether the normals within any contact patch differ from each other."""
    start = contacts.patch_start
    return not np.array_equal(
        contacts.normals, np.repeat(contacts.patch_normal, np.diff(start), axis=0)
    )


def _open_pairs(contacts: ContactSet, center: Array) -> dict[str, Any]:
    """JSON data of the open pairs (uncertain contacts): parts, and a point between them."""
    geometry = contacts.assembly.geometry
    parts = np.array([pair.ends for pair in contacts.open_pairs], dtype=np.int64)
    low, high = geometry.part_boxes
    a, b = parts.reshape(-1, 2).T
    middle = (np.maximum(low[a], low[b]) + np.minimum(high[a], high[b])) / 2
    return {"parts": pack(parts.reshape(-1, 2), "index"), "at": pack(middle - center)}


def build_orientation(answers: Everything, answer: Answered, center: Array) -> dict[str, Any]:
    """JSON data of the answer for a direction of gravity: words, motions, and forces.

    Arguments: `center` (3,): point to which positions are relative, world frame [length unit].
    """
    check, units = answer.check, answers.assembly.units
    count = len(answers.assembly.parts)
    motion = np.zeros((count, 6))
    moves = np.zeros(count, dtype=bool)
    words: dict[str, str] = {}
    for k, part in enumerate(check["parts"]):
        motion[k], moves[k] = part["acceleration"] or 0.0, part["moves"]
        if part["moves"]:
            words[str(k)] = readable(part["motion"])
    motion[:, :3] /= metres_per_unit(units)
    keys = ("verdict", "guarantee", "seated", "instability", "z")
    return {
        **{key: check.get(key) for key in keys},
        "sentence": readable(check["sentence"]),
        "why": answer.sentence,
        "level": dict(facts(check)).get("level"),
        "down": answer.down.tolist(),
        "motion": pack(motion) if motion.any() else None,
        "moves": pack(moves, "u1"),
        "words": words,
        "forces": None
        if answer.balance is None
        else _balance(answer.balance, answers.contacts, center),
        "force_words": forces_phrase(check["forces"]),
        "fall": _fall(answer, answers.assembly),
    }


def _fall(answer: Answered, assembly: Assembly) -> dict[str, Any] | None:
    """JSON data of the fall of a balanced assembly; None for any other verdict.

    `begins` is the first derivative of the path. `places` has the poses, lengths [length unit] and
    energies [J] along the path, or is None if the path was not computed.
    """
    second = answer.check["second_order"]
    if second is None or second["state"] != "balanced":
        return None
    begins = np.zeros((len(assembly.parts), 6))
    for name, motion in second["motion"].items():
        begins[assembly.index[name]] = motion
    moves, places, path = begins.any(axis=1), None, answer.path
    if path is not None:
        moves |= path.motions.any(axis=(0, 2))
        places = {
            "motions": pack(path.motions[:, moves]),
            "energies": pack(path.energies * metres_per_unit(assembly.units), "f8"),
            "lengths": pack(path.lengths, "f8"),
        }
    return {
        "parts": np.flatnonzero(moves).tolist(),
        "begins": pack(begins),
        "places": places,
        "friction": second["rolling"] or "open",
        "words": readable(second_order_words(second)),
    }


def _balance(balance: Balance, contacts: ContactSet, center: Array) -> dict[str, Any]:
    return {
        **_points(balance, contacts, center),
        "forces": pack(balance.forces),
        "pull": None if balance.pull is None else pack(balance.pull, "f8"),
        "use": None if balance.use is None else pack(balance.use),
    }


def _points(balance: Balance, contacts: ContactSet, center: Array) -> dict[str, Any]:
    """JSON data of the points at which contact forces act: position, parts, and patch.

    `patch` is None if the points are not those of the contact set.
    """
    reach = SAME * float(contacts.assembly.geometry.size.max())
    same = len(balance.points) == len(contacts.points) and bool(
        (np.abs(balance.points - contacts.points) <= reach).all()
    )
    patch = np.repeat(np.arange(len(contacts)), np.diff(contacts.patch_start))
    return {
        "points": pack(balance.points - center),
        "parts": pack(balance.parts, "index"),
        "patch": pack(patch, "index") if same else None,
    }


def _rays(answers: Everything, center: Array) -> dict[str, Any] | None:
    """JSON data of forces for gravity along each ray of the stable region; None without rays.

    None also if the rays have no common points.
    """
    rays = answers.rays
    if not rays or any(len(ray.points) != len(rays[0].points) for ray in rays):
        return None
    return {
        "downs": [ray.down.tolist() for ray in rays],
        **_points(rays[0], answers.contacts, center),
        "forces": pack(np.array([ray.forces for ray in rays])),
    }


def _region(answers: Everything) -> dict[str, Any] | None:
    """JSON data of the stable region, with the verdicts inside and outside; None without it.

    If friction makes the region round, it lies between two cones: holding is proved within
    `inner` and excluded outside `facets`. If some forces are not modelled, directions outside the
    region are undecided. A direction u is inside a cone if q.u >= -blur for every facet q. The
    inner cone has its own `blur`, which is negative if the proof needs a distance from the facet.
    """
    region, inner = answers.region, answers.inner
    if region is None:
        return None
    rests = [
        {"down": rest["down"], "state": rest["state"], "words": rest_words(rest)}
        for rest in region["rests"]
    ]
    keys = ("kind", "dimension", "lines", "rays", "equations", "facets", "center")
    band, rough = inner is not None, region["friction"]
    exact = region["exact"] or answers.none
    return {
        **{key: region[key] for key in keys},
        "half_angle_deg": region["half_angle_deg"],
        "exact": exact,
        "friction": rough,
        "blur": float(np.radians(region["accuracy_deg"] or 0.0)),
        "inner": None
        if inner is None
        else {"facets": inner.facets.tolist(), "blur": -inner.inwards or inner.blur},
        "gap_deg": region["gap_deg"],
        "rests": rests,
        "inside": "potentially-stable" if rough else "stable",
        "outside": "unstable" if region["complete"] or answers.none else "undecided",
        "words": live_words(exact=exact, band=band, friction=rough),
    }


def _map(stability_map: MapMotions | None) -> dict[str, Any] | None:
    """JSON data of the stability map: vertices, mass [kg], motion of each vertex; else None."""
    if stability_map is None:
        return None
    return {
        "vertices": pack(stability_map.vertices, "f8"),
        "mass": stability_map.mass,
        "motions": pack(stability_map.motions),
    }
