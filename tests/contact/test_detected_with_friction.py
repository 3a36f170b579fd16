"""Contacts whose friction is changed are those of a new detection, array by array."""

import dataclasses

import numpy as np
import pytest
from random_pushed import pushed_assembly

import kilter
from kilter.contact.contact_tolerances import GAP
from kilter.contact.detect import detected_with_friction


def touching(assembly):
    found = kilter.contacts(assembly)
    gap = GAP * assembly.geometry.size[found.patch_parts].min(axis=1)
    return found.patch_parts, found.patch_normal, gap


@pytest.mark.quick(2)
@pytest.mark.parametrize("seed", range(40))
def test_a_change_of_friction_equals_a_new_detection(seed: int) -> None:
    smooth = pushed_assembly(seed, touching).drawn.with_friction(0.0)
    changed = detected_with_friction(kilter.contacts(smooth), 0.3)
    # other parts have their own geometry, so that no recent search serves them
    fresh = dataclasses.replace(smooth, parts=[dataclasses.replace(part) for part in smooth.parts])
    again = kilter.contacts(fresh.with_friction(0.3))
    for one, other in ((changed, again), (changed.possible, again.possible)):
        for field in dataclasses.fields(one):
            first, second = getattr(one, field.name), getattr(other, field.name)
            if isinstance(first, np.ndarray):
                np.testing.assert_array_equal(first, second, err_msg=field.name)
