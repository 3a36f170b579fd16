"""The tolerances of assemblies and of files are in a file each, and in the order that it states."""

from itertools import pairwise

import pytest

from kilter.assembly import assembly_tolerances as a
from kilter.files import file_tolerances as f
from literals import unnamed

CHAINS = [
    (a, ("SAME_SURFACE", "COPLANAR", "SMOOTH")),
    (f, ("INTEGRAL", "RIGID", "SAME_FACE", "VOLUME", "RECOGNISED", "DEFLECTION", "TURN")),
]


@pytest.mark.parametrize(("where", "chain"), CHAINS, ids=["assembly", "files"])
def test_tolerances_are_ordered(where, chain):
    values = [getattr(where, name) for name in chain]
    assert all(low < high for low, high in pairwise(values))


def test_what_the_docstrings_call_equal_is_equal():
    assert a.SAME_SURFACE == a.PLANAR_AXIS == a.FLAT_PART == a.INSIDE_OUT
    assert f.RECOGNISED == f.SAME_ANGLE


def test_the_fifth_power_of_the_largest_size_is_a_number():
    assert a.LARGEST**5 < 1e300


@pytest.mark.slow
def test_no_small_number_goes_without_a_name():
    # masses of bricks [kg]
    found = unnamed("assembly", but="assembly_tolerances.py")
    assert {place.split(":")[0] for place in found} == {"assembly/bricks/brick_library.py"}
    # units: a micron in millimetres (3MF); prefixes and inches (STEP); and
    # the least values that MuJoCo accepts
    found = unnamed("files", but="file_tolerances.py")
    places = {place.split(":")[0] for place in found}
    assert places == {
        "files/mjcf.py",
        "files/stated_accuracy.py",
        "files/step_densities.py",
        "files/threemf.py",
    }
