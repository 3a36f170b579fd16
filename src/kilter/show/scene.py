"""An assembly and its answers as arrays to draw, about the middle of the picture.

Nothing is computed here that an answer does not hold: shapes are placed, motions and forces
are laid out part by part and point by point. Positions are float32 about `center`, so that
an assembly far from the origin keeps its digits.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.arrays import Array
from kilter.show.colours import assembly_colours
from kilter.show.packing import pack, readable
from kilter.show.round_patches import round_patches
from kilter.show.shapes import Drawn, placed
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

__all__ = ["build_scene", "build_things", "coincide"]


SAME = 1e-12
"""Points this close are one [size of the largest part]."""
SAME_DOWN = 1e-9
"""Unit directions nearer than this are one [-]."""
HELD_IN_VIEW = 1.5
"""Held parts reach at most this much farther than the free ones in the first view [-]."""


def build_scene(answers: Everything) -> dict[str, Any]:
    """What the page of an assembly draws, as JSON data."""
    things = build_things(answers.assembly, answers.contacts)
    center, recommended = np.array(things["center"]), answers.recommended
    same = coincide(answers)
    return {
        **things,
        "given": _orientation(answers, answers.given, center),
        "recommended": None
        if recommended is None or same
        else _orientation(answers, recommended, center),
        "coincide": same,
        "region": _region(answers),
        "rays": _rays(answers, center),
        "map": _map(answers.map),
        "change": _change(answers, center),
        "notes": list(answers.notes),
    }


def coincide(answers: Everything) -> bool:
    """Whether the direction that is recommended is that of gravity as given."""
    one = answers.recommended
    return one is not None and float(np.linalg.norm(one.down - answers.given.down)) < SAME_DOWN


def build_things(assembly: Assembly, contacts: ContactSet) -> dict[str, Any]:
    """What every page draws of an assembly: shapes, parts, contact patches, loads."""
    center, extent = _view(assembly)
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
    }


def _view(assembly: Assembly) -> tuple[Array, Array]:
    """Middle and half lengths of the box that the first view must hold [length unit].

    A table reaches out of it on every side.
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
    return [_shape(shape) for shape in placed(assembly).shapes]


def _shape(shape: Drawn) -> dict[str, Any]:
    return {
        "positions": pack(shape.positions),
        "triangles": pack(shape.triangles, "index"),
        "edges": pack(shape.edges, "index"),
    }


def _change(answers: Everything, center: Array) -> dict[str, Any] | None:
    """The brick to take away, by its number, or the one to add: its shape, and where."""
    best = None if answers.change is None else answers.change.best
    if best is None:
        return None
    if best.what == "remove":
        return {"part": answers.assembly.index_of(best.name)}
    places, k = placed(best.assembly), best.assembly.index_of(best.name)
    at = (places.position[k] - center).tolist()
    return {"part": None, "shape": _shape(places.shapes[places.shape[k]]), "at": at}


def _parts(assembly: Assembly, center: Array) -> dict[str, Any]:
    geometry, places = assembly.geometry, placed(assembly)
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
        "colour": pack(assembly_colours(assembly, places.shape), "u1"),
    }


def _patches(contacts: ContactSet, center: Array) -> dict[str, Any]:
    kinds, kind = np.unique(contacts.patch_kind, return_inverse=True)
    rings = round_patches(contacts)
    widest = np.abs(contacts.patch_gap).argmax(axis=1) if len(contacts) else np.zeros(0, int)
    return {
        "parts": pack(contacts.patch_parts, "index"),
        "start": pack(contacts.patch_start, "index"),
        "points": pack(contacts.points - center),
        "normal": pack(contacts.patch_normal),
        "normals": pack(contacts.normals) if _curved(contacts) else None,
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


def _curved(contacts: ContactSet) -> bool:
    """Whether normals differ within a patch."""
    start = contacts.patch_start
    return not np.array_equal(
        contacts.normals, np.repeat(contacts.patch_normal, np.diff(start), axis=0)
    )


def _open_pairs(contacts: ContactSet, center: Array) -> dict[str, Any]:
    """Where the open pairs are: in the middle of what their boxes share, or between them."""
    geometry = contacts.assembly.geometry
    parts = np.array([one.parts for one in contacts.open_pairs], dtype=np.int64)
    low, high = geometry.part_boxes
    a, b = parts.reshape(-1, 2).T
    middle = (np.maximum(low[a], low[b]) + np.minimum(high[a], high[b])) / 2
    return {"parts": pack(parts.reshape(-1, 2), "index"), "at": pack(middle - center)}


def _orientation(answers: Everything, one: Answered, center: Array) -> dict[str, Any]:
    """One direction of gravity: words and figures, motion a part, forces a point."""
    check, units = one.check, answers.assembly.units
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
        "why": one.sentence,
        "level": dict(facts(check)).get("level"),
        "down": one.down.tolist(),
        "motion": pack(motion) if moves.any() else None,
        "moves": pack(moves, "u1"),
        "words": words,
        "forces": None if one.balance is None else _balance(one.balance, answers.contacts, center),
        "force_words": forces_phrase(check["forces"]),
        "fall": _fall(one, answers.assembly),
    }


def _fall(one: Answered, assembly: Assembly) -> dict[str, Any] | None:
    """How what is balanced falls: its first derivative, and the places along its path [J]."""
    second = one.check["second_order"]
    if second is None or second["state"] != "balanced":
        return None
    begins = np.zeros((len(assembly.parts), 6))
    for name, motion in second["motion"].items():
        begins[assembly.index[name]] = motion
    moves, places, path = begins.any(axis=1), None, one.path
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
    pull = None if balance.pull is None else pack(balance.pull, "f8")
    return {**_points(balance, contacts, center), "forces": pack(balance.forces), "pull": pull}


def _points(balance: Balance, contacts: ContactSet, center: Array) -> dict[str, Any]:
    """Where forces act, on which parts, and of which patch: None where they are not its points."""
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
    """Forces at the same points for several directions; None where there are none to show."""
    rays = answers.rays
    if not rays or any(len(ray.points) != len(rays[0].points) for ray in rays):
        return None
    return {
        "downs": [ray.down.tolist() for ray in rays],
        **_points(rays[0], answers.contacts, center),
        "forces": pack(np.array([ray.forces for ray in rays])),
    }


def _region(answers: Everything) -> dict[str, Any] | None:
    """The region, and what lies within, outside and between.

    Where friction makes it round, `inner` bounds what surely holds and `facets` what may;
    where it is exact but for forces that are not modelled, what lies outside is undecided.
    A direction is within where it meets every facet to `blur`, of the inner cone to its own,
    which is negative where it asks for more than the facet.
    """
    region, inner = answers.region, answers.inner
    if region is None:
        return None
    rests = [
        {"down": one["down"], "state": one["state"], "words": rest_words(one)}
        for one in region["rests"]
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


def _map(found: MapMotions | None) -> dict[str, Any] | None:
    if found is None:
        return None
    return {
        "vertices": pack(found.vertices, "f8"),
        "mass": found.mass,
        "motions": pack(found.motions),
    }
