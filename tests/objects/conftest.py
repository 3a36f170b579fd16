"""Fixture for objects of other libraries: an object and its file give the same answer."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import kilter


def summary(assembly: kilter.Assembly) -> dict[str, Any]:
    verdict = kilter.check(assembly)
    moving = sorted(name for name, part in zip(assembly.names, verdict.to_dict()["parts"],
                    strict=True) if part["moves"])  # fmt: skip
    masses = dict(zip(assembly.names, assembly.geometry.mass.tolist(), strict=True))
    return {
        "verdict": verdict.verdict,
        "moving": moving,
        "held": sorted(part.name for part in assembly.parts if part.grounded),
        "units": assembly.units,
        "masses": masses,
    }


@pytest.fixture
def agree(tmp_path: Path) -> Callable[..., kilter.Assembly]:
    """Loads an object and the file that its library writes, and compares their answers.

    Returns the assembly of the object. `verdict`: the expected verdict of both.
    """

    def asked(
        value: Any, write: Callable[[Path], Any], name: str, verdict: str, **options: Any
    ) -> kilter.Assembly:
        path = tmp_path / name
        write(path)
        direct, through = kilter.load(value, **options), kilter.load(path, **options)
        one, other = summary(direct), summary(through)
        masses, expected = one.pop("masses"), other.pop("masses")
        assert one == other
        assert one["verdict"] == verdict
        assert masses == pytest.approx(expected, rel=1e-6)
        return direct

    return asked
