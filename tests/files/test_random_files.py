"""Random damaged files: read with the volumes of a second program, or rejected with a message."""

from pathlib import Path

import numpy as np
import pytest
from random_files import Made, mesh_file, step_file

from kilter.assembly import Assembly
from kilter.cli import main
from kilter.errors import InputError
from kilter.loading import load

CASES = {"mesh": 24, "STEP": 5}
"""Files in the quick suite; the slow suite has more."""
SEEDS = 25
"""Files in a block of the slow suite."""
BLOCKS = {"mesh": 6, "STEP": 2}
"""Blocks of the slow suite; a STEP file takes ten times longer than a mesh file."""


def held(path: Path) -> Assembly:
    return load(path, ground="*")


def rechecked(made: Made, capsys: pytest.CaptureFixture[str], slack: float) -> str:
    """The result of reading a file: "read", "mended" or "refused"."""
    code = main(["contacts", str(made.path)])
    said = capsys.readouterr()
    assert code in (0, 2), said.err
    if code == 2:
        assert made.spoilt
        lines = [line for line in said.err.splitlines() if "warning:" not in line]
        assert len(lines) == 1, said.err
        assert "; " in lines[0]  # fault and remedy
        with pytest.raises(InputError):
            _ = load(made.path).geometry
        flat = None
        try:
            _ = held(made.path).geometry  # a held part may be open
        except InputError as error:
            flat = error
        if flat is not None and "no solid" in flat.what:  # spheres that lost their only face
            assert made.spoilt == set(made.volumes)
            assert all(f"{name!r} (1 shell)" in flat.what for name in made.volumes)
            return "refused"
        # only a flat face is left
        assert flat is None or (flat.part in made.spoilt and "the part is flat" in flat.what)
        return "refused"
    assembly = load(made.path)
    geometry = assembly.geometry
    # a sphere or torus that lost its only face is listed as ignored
    passed = [note for note in assembly.notes if "ignored, not solids" in note]
    gone = {name for name in made.spoilt if any(f"{name}' (1 shell)" in note for note in passed)}
    assert sorted(assembly.names) == sorted(set(made.volumes) - gone)
    for k, name in enumerate(assembly.names):
        doubted = any(repr(name) in note for note in assembly.notes)
        if name not in made.spoilt and not doubted:
            size = float(geometry.size[k])
            assert geometry.volume[k] == pytest.approx(made.volumes[name], rel=slack)
            away = np.linalg.norm(geometry.center[k] - made.centers[name])
            assert away <= slack * max(size, float(np.abs(made.centers[name]).max()))
    if made.turned:
        assert any("wrong winding" in warning for warning in geometry.warnings)
    return "mended" if made.spoilt or made.turned else "read"


def round_of(kind: str, seeds: range, folder: Path, capsys: pytest.CaptureFixture[str]) -> set[str]:
    seen = set()
    for seed in seeds:
        rng = np.random.default_rng([len(kind), seed])
        made = mesh_file(rng, folder) if kind == "mesh" else step_file(rng, folder)
        try:
            seen.add(rechecked(made, capsys, 1e-5 if kind == "mesh" else 1e-7))
        except BaseException as error:
            raise AssertionError(f"{kind} {seed}") from error
    return seen


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["mesh", "STEP"])
def test_a_short_round(kind, tmp_path, capsys):
    if kind == "STEP":
        pytest.importorskip("OCP")
    assert {"read", "mended"} <= round_of(kind, range(CASES[kind]), tmp_path, capsys)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "first"), [(kind, SEEDS * k) for kind, count in BLOCKS.items() for k in range(count)]
)
def test_a_long_round(kind, first, tmp_path, capsys):
    if kind == "STEP":
        pytest.importorskip("OCP")
    seeds = range(max(first, CASES[kind]), first + SEEDS)
    seen = round_of(kind, seeds, tmp_path, capsys)
    assert seen - {"refused"}
    assert len(seeds) < SEEDS or {"read", "mended"} <= seen
