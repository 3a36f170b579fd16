"""Assemblies from public data sets, in a folder beside the checkout."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from kilter.analysis.check import check
from kilter.files import from_dict, load, to_dict
from sampled import sampled

DATA = Path(__file__).resolve().parents[3] / "shared" / "data"

pytestmark = pytest.mark.skipif(
    not DATA.is_dir(), reason="real data is not here: ../shared/data beside the checkout"
)

COUNTS = {"A": 3, "H": 3, "bridge": 16, "cube-curve-short": 2, "cubes": 3}
COUNTS |= {"shelf-stable": 9, "type-a": 3, "type-c": 3}


@pytest.mark.quick(2)
@pytest.mark.parametrize(("name", "count"), COUNTS.items(), ids=COUNTS)
def test_compas(name: str, count: int) -> None:
    assembly = load(DATA / "compas_cra" / f"{name}.json", density=2000)
    assert assembly.names == tuple(str(k) for k in range(count))
    assert (assembly.geometry.volume > 0).all()
    assert not assembly.geometry.warnings
    assert assembly.geometry.single.all() == (name not in ("type-a", "type-c"))
    assert bool(assembly.notes) == (name == "cube-curve-short")  # 72 interfaces
    written = to_dict(assembly)
    assert to_dict(from_dict(written, folder=".", source="")) == written


@pytest.mark.parametrize(
    ("name", "count", "accuracy"), [("tetris-2", 17, 1e-7), ("dome", 73, 5e-9)]
)
def test_folders(name: str, count: int, accuracy: float, capfd) -> None:
    assembly = load(DATA / "learn2assemble" / name)
    assert assembly.names == tuple(str(k) for k in range(count))
    assert assembly.notes == ("ignored, not mesh or STEP files: 'rbe_admm.json'",)
    assert assembly.geometry.accuracy.max() == pytest.approx(accuracy, rel=0.6)
    assert capfd.readouterr() == ("", "")


# COMPAS ---------------------------------------------------------------------------------


@pytest.mark.parametrize("old", ["2db5a65-cubes", "84da9ff-cubes"])
def test_files_of_2021_equal_what_they_were_made_into(old: str) -> None:
    first, second = (load(DATA / "compas_cra" / f"{n}.json") for n in (f"old/{old}", "cubes"))
    assert to_dict(first) == to_dict(second)


def test_densities_turn_the_verdict_over() -> None:
    assembly = load(DATA / "compas_cra" / "densities.json", ground="0")
    assert assembly.geometry.mass / assembly.geometry.volume == pytest.approx([1, 1, 10])
    assert check(assembly).verdict == "stable"
    alike = [dataclasses.replace(part, density=None) for part in assembly.parts]
    assert check(dataclasses.replace(assembly, parts=alike)).verdict == "unstable"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mu", "forces"), sampled(2, [(0, False), (0.04, False), (0.02, False), (0.84, True)])
)
def test_curved_blocks_on_the_interfaces_of_the_file(mu: float, forces: bool) -> None:
    """The friction limit is near .051; below it, the blocks slide along -x."""
    path = DATA / "compas_cra" / "curve-3-blocks.json"
    found = check(load(path, ground="0", contacts="file", friction=mu))
    assert (found.verdict != "unstable") == forces
    assert len(found.contact_set) == 40
    assert found.evidence is not None


@pytest.mark.slow
def test_crossvault_on_the_interfaces_of_the_file() -> None:
    path = DATA / "compas_assembly" / "crossvault.json"
    assembly = load(path, contacts="file", friction=0.84)
    assert [part.name for part in assembly.parts if part.grounded] == ["180", "181", "182", "183"]
    found = check(assembly)
    assert len(found.contact_set) == 488
    assert found.verdict not in ("unstable", "undecided")
