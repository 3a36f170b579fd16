import subprocess
import sys

import numpy as np
import pytest
from scene_oracle import imbalance, overlapping, touching

from kilter.assembly import Assembly
from kilter.errors import InputError
from kilter.scenes import SCENES, example, scene

BUILT = {name: entry.build() for name, entry in SCENES.items()}


@pytest.mark.parametrize("name", SCENES)
class TestEveryScene:
    @pytest.mark.quick(22)
    def test_is_an_assembly_with_something_held_and_something_free(self, name):
        assembly = BUILT[name]
        assert isinstance(assembly, Assembly)
        assert 0 < assembly.geometry.grounded.sum() < len(assembly.parts)

    @pytest.mark.quick(24)
    def test_has_masses_and_volumes_above_zero(self, name):
        geometry = BUILT[name].geometry
        assert (geometry.mass > 0).all()
        assert (geometry.volume > 0).all()
        assert geometry.warnings == ()

    @pytest.mark.quick("tower", "arch", "wall", "bracket", "slot")
    def test_has_no_parts_that_overlap(self, name):
        meant = [("post", "screw")] if name == "cad-export" else []
        assert overlapping(BUILT[name]) == meant

    @pytest.mark.quick(2)
    def test_has_contacts_that_touch_exactly(self, name):
        assembly = BUILT[name]
        assert touching(assembly).gap.max(initial=0.0) < 1e-12

    @pytest.mark.quick(1)
    def test_has_the_answer_it_says(self, name):
        assembly, answer = BUILT[name], SCENES[name].answer
        has_friction = bool(assembly.friction or assembly.friction_pairs or assembly.contacts)
        without = imbalance(assembly)
        if without < 1e-9:
            # a small push makes a tip fall from a tip
            assert answer in ("stable", "balanced") or name == "paper-figure-3-plane"
        else:
            assert without > 1e-3
            assert has_friction == (answer in ("stable", "settles", "potentially-stable"))

    @pytest.mark.quick(22)
    def test_is_named_and_told_in_a_line(self, name):
        entry = SCENES[name]
        assert entry.name == name == name.lower().replace(" ", "-")
        assert 0 < len(entry.title) <= 80
        assert "\n" not in entry.title
        assert entry.source


def test_there_are_scenes_of_every_answer():
    assert {entry.answer for entry in SCENES.values()} == {
        "stable",
        "settles",
        "potentially-stable",
        "balanced",
        "unstable",
    }


def test_builds_the_same_scene_each_time():
    for name in ("box-pile", "corner-wedges"):
        one, two = scene(name).geometry, scene(name).geometry
        assert np.array_equal(one.vertices, two.vertices)


def test_unknown_name_names_the_nearest():
    with pytest.raises(InputError, match="did you mean 'harmonic-stack'"):
        scene("harmonic-stak")
    with pytest.raises(InputError, match="use one of: paper-figure-1"):
        scene("??")


@pytest.mark.slow
def test_listing_the_examples_is_light():
    code = (
        "import sys, kilter; kilter.example();"
        "print([m for m in ('scipy', 'shapely', 'highspy', 'pydantic') if m in sys.modules])"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == "[]"


def test_an_example_is_an_assembly_or_the_list_of_all():
    listed = example()
    assert [entry.name for entry in listed] == list(SCENES)
    assert example("tower").names == scene("tower").names
    assert listed[0].to_dict().keys() == {"name", "title", "source", "answer"}
    assert all("\n" not in repr(entry) for entry in listed)
