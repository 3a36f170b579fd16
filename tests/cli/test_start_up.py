"""Modules that the start of a program imports, each in a process of its own."""

import subprocess
import sys

import pytest

HEAVY = (
    "clarabel", "highspy", "manifold3d", "matplotlib", "numpy", "pydantic", "scipy", "shapely",
    "trimesh",
)  # fmt: skip
"""Packages that take long to import."""


@pytest.mark.parametrize(
    ("code", "allowed"),
    [
        pytest.param("import kilter", set(), id="library"),
        pytest.param("from kilter.cli import main; main(['--help'])", set(), id="help"),
        pytest.param("import kilter; kilter.Assembly", {"numpy"}, id="assembly"),
    ],
)
@pytest.mark.quick("help")
def test_the_start_imports_few_packages(code: str, allowed: set[str]) -> None:
    listing = f"{code}\nimport sys\nprint(*sys.modules, file=sys.stderr)"
    ended = subprocess.run(
        [sys.executable, "-c", listing], capture_output=True, text=True, check=True, timeout=60
    )
    loaded = {name.partition(".")[0] for name in ended.stderr.split()}
    assert "kilter" in loaded
    assert loaded & set(HEAVY) <= allowed
