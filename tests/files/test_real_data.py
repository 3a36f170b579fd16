"""Assemblies that others made, beside the checkout."""

from __future__ import annotations

from pathlib import Path

import pytest

from kilter.files import from_dict, load, to_dict

DATA = Path(__file__).resolve().parents[3] / "shared" / "data"

pytestmark = pytest.mark.skipif(
    not DATA.is_dir(), reason="real data is not here: ../shared/data beside the checkout"
)

COUNTS = {"A": 3, "H": 3, "bridge": 16, "cube-curve-short": 2, "cubes": 3}
COUNTS |= {"shelf-stable": 9, "type-a": 3, "type-c": 3}


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
    assert assembly.notes == ("passed over, no mesh or STEP files: 'rbe_admm.json'",)
    assert assembly.geometry.accuracy.max() == pytest.approx(accuracy, rel=0.6)
    assert capfd.readouterr() == ("", "")
