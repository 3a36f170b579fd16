"""Bonds in the output of forces and contacts: pulls in table and page."""

from __future__ import annotations

import pytest

import kilter
from kilter import Assembly, Bond, Box, Part, Pose
from kilter.contact import contacts
from kilter.tell.tables import forces_table, tables

G = 9.81
WEIGHT = 1000 * G


def cube(name, z=0.0, **more):
    return Part(name, Box([1, 1, 1]), Pose([0, 0, z]), **more)


def hung(pull=WEIGHT, shift=0.0):
    """A cube below a held cube, displaced sideways by `shift`."""
    low = Part("low", Box([1, 1, 1]), Pose([shift, 0, 0]))
    return Assembly([cube("top", z=1.0, grounded=True), low], bonds=[Bond(("low", "top"), pull)])


@pytest.mark.parametrize("shift", [0.0, 0.1])
def test_a_pull_acts_where_it_is_needed(shift):
    # at the shift d, the middle of the common face is at d / 2 and the weight at d
    found = kilter.check(hung(shift=shift)).forces
    assert found.center[0][0] == pytest.approx(shift, abs=1e-6)
    assert found.center[0][2] == pytest.approx(0.5)
    assert abs(found.normal_force[0]) == pytest.approx(WEIGHT)
    most = 1 / 4 + (shift / 2) / (1 - shift) / 2  # half of W / 2 + moment / width
    assert found.bond_utilisation[0] == pytest.approx(most, abs=1e-6)


def test_the_table_of_forces_has_a_column_for_bonds_where_there_are_some():
    table = forces_table(kilter.check(hung()).to_dict())
    assert table.head[-1] == "bond used"
    assert table.rows(9)[0][-1] == "25 %"
    assert "-" not in table.rows(9)[0][3:5]
    plain = forces_table(kilter.check(kilter.example("tower")).to_dict())
    assert plain.head[-1] == "friction needed"
    assert len(plain.rows(1)[0]) == len(plain.head)


def test_contacts_tell_what_their_bonds_hold():
    parts = [cube("a", grounded=True), cube("b", z=1.0), cube("c", z=2.0), cube("d", z=3.0)]
    bonds = [Bond(("a", "b"), 5.0), Bond(("b", "c"), pull_per_area=7.0)]
    found = contacts(Assembly(parts, bonds=bonds))
    told = {tuple(patch["parts"]): patch["pull"] for patch in found.to_dict()["patches"]}
    assert told == {("a", "b"): 20.0, ("b", "c"): pytest.approx(7.0), ("c", "d"): None}
    [table] = [one for one in tables(found.to_dict()) if one.title == "Contact patches:"]
    assert table.head[-1] == "bond pulls up to"
    assert sorted(row[-1] for row in table.rows(9)) == ["-", "20 N", "7 N"]
