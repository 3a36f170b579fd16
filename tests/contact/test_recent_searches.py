"""Values of a recent search serve the next search of the same bodies, with an equal result."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from solids import bore, peg

import kilter
from kilter import Assembly, Part, Pose, Tolerance
from kilter.contact import detect
from kilter.contact.common import contact_search as recent_searches
from kilter.scenes import scene


def pegs() -> Assembly:
    """A peg with play in a bore, and a tight one in another bore."""
    plates = [
        Part(name, bore(1.0, 3.0, 0.0, 1.0, sides=48), Pose([x, 0, 0]), grounded=True)
        for name, x in (("left", 0.0), ("right", 10.0))
    ]
    shafts = [
        Part("loose", peg(0.95, 0.0, 2.0, sides=48), Pose([0.01, 0, 0])),
        Part("tight", peg(1.01, 0.0, 2.0, sides=48), Pose([10, 0, 0])),
    ]
    return Assembly([*plates, *shafts])


def fresh(assembly: Assembly) -> Assembly:
    """A copy with a geometry of its own, which no recent search knows."""
    parts = [dataclasses.replace(part) for part in assembly.parts]
    return dataclasses.replace(assembly, parts=parts)


def assert_equal(first: kilter.ContactSet, second: kilter.ContactSet) -> None:
    """Compare all arrays and records of two contact sets."""
    for field in dataclasses.fields(first):
        one, other = getattr(first, field.name), getattr(second, field.name)
        if isinstance(one, np.ndarray):
            np.testing.assert_array_equal(one, other, err_msg=field.name)
        elif isinstance(one, tuple):
            assert repr(one) == repr(other), field.name  # records with arrays have no ==
    assert first.to_dict() == second.to_dict()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["tower", "pegs"])
@pytest.mark.parametrize(
    "tolerance", [Tolerance(gap=0.1), Tolerance.loose(), Tolerance(clearance=0.08)]
)
def test_another_tolerance_gives_the_contacts_of_a_new_geometry(name, tolerance):
    assembly = pegs() if name == "pegs" else scene(name)
    kilter.contacts(assembly)
    again = kilter.contacts(assembly, tolerance=tolerance)
    assert_equal(again, kilter.contacts(fresh(assembly), tolerance=tolerance))


def test_equal_conditions_need_no_second_search(monkeypatch):
    """Friction changes no finding; a new tolerance, and a new geometry, need a search."""
    assembly = pegs()
    examined = []
    examine = detect.examine
    monkeypatch.setattr(
        detect, "examine", lambda *given: examined.append(given[2]) or examine(*given)
    )
    kilter.contacts(assembly)
    rubbing = kilter.contacts(assembly.with_friction(0.4))
    assert len(examined) == 1
    assert (rubbing.patch_mu == 0.4).all()
    kilter.contacts(assembly, tolerance=Tolerance(gap=0.1))
    assert len(examined) == 2
    kilter.contacts(fresh(assembly))
    assert len(examined) == 3


def test_given_contacts_are_a_condition_of_a_search():
    assembly = scene("tower")
    found = kilter.contacts(assembly)
    a, b = (assembly.names[k] for k in found.patch_parts[0])
    given = kilter.GivenContact((a, b), found[0].points, found[0].normal)
    listed = dataclasses.replace(assembly, contacts=(given,))
    vars(listed)["geometry"] = assembly.geometry
    kinds = kilter.contacts(listed).patch_kind.tolist()
    assert kinds.count("given") == 1
    assert len(kinds) == len(found)


@pytest.mark.slow
def test_searches_of_large_geometries_are_not_kept(monkeypatch):
    assembly = pegs()
    monkeypatch.setattr(recent_searches, "MOST_TRIANGLES", 10)
    kilter.contacts(assembly)
    assert recent_searches.recent_searches(assembly.geometry).search is None


def test_the_oldest_findings_give_way():
    assembly = scene("tower")
    for k in range(recent_searches.MOST_FINDINGS + 2):
        kilter.contacts(assembly, tolerance=Tolerance(gap=1e-6 * (k + 1)))
    kept = recent_searches.recent_searches(assembly.geometry).findings
    gaps = [tolerance.gap for tolerance, *_ in kept]
    assert gaps == pytest.approx([1e-6 * k for k in (3, 4, 5, 6)])
