"""Kept contacts of a changed assembly are equal to those of a new search."""

from __future__ import annotations

import dataclasses
import json
import random
from pathlib import Path

import pytest

import kilter
from kilter.assembly import Assembly, GivenContact
from kilter.contact import ContactSet, Tolerance, detect
from kilter.contact.kept_contacts import KeptContacts
from kilter.scenes import scene
from kilter.scenes.registry import SCENES

QUICK = ("tower", "wall", "paper-figure-8", "ball-in-groove")
CHANGES = 4
MOST_PARTS = 120


def written(contacts: ContactSet) -> str:
    """Everything about contacts as text."""
    possible, degenerate = contacts.possible, contacts.degenerate
    arrays = [possible.part_a, possible.part_b, possible.points, possible.normals, possible.mu]
    arrays += [possible.two_sided, possible.degenerate, degenerate.part_a, degenerate.normals]
    arrays += [degenerate.held_parts, degenerate.held_points, contacts.patch_doubt]
    return json.dumps([contacts.to_dict(), *(array.tolist() for array in arrays)])


def changed(assembly: Assembly, kept: KeptContacts, rng: random.Random) -> Assembly:
    """A random change that keeps the bodies in place."""
    names = list(assembly.names)
    other = assembly
    if rng.random() < 0.5:
        other = other.with_friction(rng.choice([0, 0.3, 0.7]))
    if rng.random() < 0.5 and len(names) > 3:
        other = other.without(rng.sample(names, rng.randint(1, 2)))
    always = {part.name for part in kept.assembly.parts if part.grounded}
    share = rng.random()
    loaded = {load.part for load in other.loads}
    parts = [
        dataclasses.replace(
            part,
            grounded=part.name in always
            or part.table
            or (part.name not in loaded and rng.random() < share),
        )
        for part in other.parts
    ]
    other = dataclasses.replace(other, parts=parts)
    if rng.random() < 0.4 and len(other.names) > 2:
        pair = tuple(rng.sample(other.names, 2))
        given = [c for c in other.contacts if set(c.parts) != set(pair)]
        other = dataclasses.replace(
            other, contacts=[*given, GivenContact((pair[0], pair[1]), [], [0, 0, 1])]
        )
    return other


def compare(assembly: Assembly, seed: int) -> int:
    """Compare kept with new contacts for random changes; return the number of comparisons."""
    rng = random.Random(seed)
    tolerance = assembly.tolerance or Tolerance()
    held = [part.name for part in assembly.parts if part.grounded and not part.table]
    kept = KeptContacts.find(assembly, tolerance, held=[n for n in held if rng.random() < 0.3])
    compared = 0
    for _ in range(CHANGES):
        try:
            other = changed(assembly, kept, rng)
        except kilter.InputError:
            continue  # for instance a joint whose part is left out
        if not kept.serves(other, tolerance):
            continue
        new = detect.contacts(other, tolerance=tolerance)
        assert written(kept.contacts(other)) == written(new)
        compared += 1
    return compared


@pytest.mark.parametrize("name", [name for name in QUICK if name in SCENES])
def test_kept_contacts_equal_those_of_a_new_search(name: str) -> None:
    assert compare(scene(name), 1) > 0


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_kept_contacts_of_every_example(seed: int) -> None:
    small = [name for name in sorted(SCENES) if len(scene(name).parts) <= MOST_PARTS]
    assert sum(compare(scene(name), seed) for name in small) > 2 * len(small)


DATA = Path(__file__).resolve().parents[3] / "shared" / "data"
FILES = ("cax-if/as1-oc-214.stp", "cax-if/dm1-id-214.stp", "cad/flange_coupling.step")


@pytest.mark.slow
@pytest.mark.parametrize("name", FILES)
def test_kept_contacts_of_cad(name: str) -> None:
    if not (DATA / name).exists():
        pytest.skip("../shared/data is not here")
    assert compare(kilter.load(DATA / name), 3) > 0


def test_another_shape_pose_tolerance_or_free_part_is_not_served() -> None:
    tower = scene("tower")
    tolerance = Tolerance()
    base = next(part.name for part in tower.parts if part.grounded)
    kept = KeptContacts.find(tower, tolerance, held=[base])
    assert kept.serves(tower, tolerance)
    assert not kept.serves(tower, Tolerance(gap=0.1))
    assert not kept.serves(tower.with_pose("cube-1", [0, 0, 5]), tolerance)
    free = [dataclasses.replace(part, grounded=False) for part in tower.parts]
    assert not kept.serves(dataclasses.replace(tower, parts=free), tolerance)
    renamed = tower.renamed({"cube-1": "other"})
    assert not kept.serves(renamed, tolerance)
