"""A body drawn twice in the same place: one overlap, and no contacts of its own."""

from __future__ import annotations

import json

import numpy as np
import pytest
from tubes import pin, tube

from kilter.assembly import Assembly, Part
from kilter.contact import ContactSet, Tolerance, contacts, detect, pair_findings
from kilter.contact.common.patches import SAME_BODY
from kilter.contact.contact_tolerances import SAME_PLACE
from kilter.contact.fits.suggestions import parts_to_leave_out
from kilter.contact.kept_contacts import KeptContacts
from kilter.rigid import Pose
from kilter.scenes.pieces import block

BASE = block("base", [-5, -5, -1], [5, 5, 0], grounded=True)
RADIUS, HEIGHT = 0.7, 2.0


def twice(off: float = 0.0) -> Assembly:
    """A tube with a pin and its copy, which is moved by `off`, on a base."""
    ring = tube("ring", 1.0, 2.0, 2.0, at=[0, 0, 1])
    pins = [pin(name, RADIUS, HEIGHT, [x, 0, 1]) for name, x in (("pin", 0.0), ("copy", off))]
    return Assembly([BASE, ring, *pins])


def of_pair(found: ContactSet) -> int:
    """Number of patches and records, except overlaps, of the pair pin and copy."""
    names = found.assembly.names
    pair = {names.index("pin"), names.index("copy")}
    records = [*found.patch_parts.tolist(), *(r.parts for r in found.unsupported)]
    records += [r.parts for r in found.rejected]
    return sum(set(parts) == pair for parts in records)


def written(found: ContactSet) -> str:
    return json.dumps(found.to_dict())


def test_the_copy_of_a_round_pin_is_an_overlap_with_its_exact_volume() -> None:
    found = contacts(twice())
    (overlap,) = found.overlaps
    assert overlap.why == SAME_BODY
    assert overlap.volume == pytest.approx(np.pi * RADIUS**2 * HEIGHT, rel=1e-12)
    assert overlap.share == 1.0
    assert of_pair(found) == 0
    kinds = {frozenset(pair.ends): pair.kind for pair in found.open_pairs}
    assert kinds[frozenset(overlap.ends)] == "overlap"


def test_other_contacts_are_those_without_the_copy() -> None:
    assembly = twice()
    alone = contacts(assembly.without(["copy"]))
    found = contacts(assembly)
    kept = ~(found.patch_parts == assembly.names.index("copy")).any(axis=1)
    assert kept.sum() == len(alone.patch_area)
    assert np.array_equal(found.patch_area[kept], alone.patch_area)


def test_both_sides_of_the_limit_between_a_copy_and_an_overlap() -> None:
    size = float(twice().geometry.size[2])
    near, far = (contacts(twice(share * SAME_PLACE * size)) for share in (0.5, 2.0))
    assert [overlap.why for overlap in near.overlaps] == [SAME_BODY]
    assert [overlap.why for overlap in far.overlaps] == ["overlap"]


def test_a_copy_thinner_than_the_tolerance_is_no_overlap() -> None:
    sheets = [block(name, [0, 0, 0], [1, 1, 0.01]) for name in ("one", "two")]
    assembly = Assembly([BASE, *sheets])
    assert [o.why for o in contacts(assembly, tolerance=Tolerance(gap=0.009)).overlaps] == [
        SAME_BODY
    ]
    assert contacts(assembly, tolerance=Tolerance(gap=0.011)).overlaps == ()


def test_a_copy_is_left_out_although_a_block_lies_in_its_variant() -> None:
    """Both overlaps have the share 1; only the copy is certainly too many."""
    block_in_variant = [block("block", [3, 3, 0], [4, 4, 1]), block("long", [3, 3, 0], [4, 5, 1])]
    assembly = Assembly([BASE, *block_in_variant, *twice().parts[1:]])
    found = contacts(assembly)
    assert [overlap.why for overlap in found.overlaps] == ["overlap", SAME_BODY]
    assert [overlap.share for overlap in found.overlaps] == pytest.approx([1.0, 1.0])
    assert parts_to_leave_out(found) == ("copy",)


@pytest.mark.slow
def test_a_copy_under_a_time_limit_and_in_kept_contacts(monkeypatch: pytest.MonkeyPatch) -> None:
    assembly, tolerance = twice(), Tolerance()
    more = Assembly([*assembly.parts, Part("third", assembly["pin"].shape, Pose([0, 0, 1]))])
    kept = KeptContacts.find(more, tolerance)
    for other in (more, more.without(["pin"]), more.with_grounded(["base", "pin", "copy"])):
        assert written(kept.contacts(other)) == written(detect.contacts(other, tolerance=tolerance))
    monkeypatch.setattr(pair_findings, "FIRST_BATCH", 1)
    monkeypatch.setattr(pair_findings, "GROWTH", 1.0)
    in_time = contacts(more, time_limit=1000.0)
    assert in_time.overlaps == contacts(more).overlaps
    assert len(in_time.overlaps) == 3
