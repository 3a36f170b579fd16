"""Modules that the start of a program imports, each in a process of its own."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

HEAVY = (
    "clarabel", "highspy", "manifold3d", "matplotlib", "numpy", "pydantic", "scipy", "shapely",
    "trimesh",
)  # fmt: skip
"""Packages whose import is slow."""
UNUSED = (
    "kilter.contact.curved.curved_contacts", "kilter.contact.sharp.normals",
    "kilter.files.step_solids", "kilter.second_order.answer.one_cluster",
    "manifold3d", "matplotlib", "numpy.f2py", "numpy.testing", "pydantic", "scipy.linalg",
    "scipy.optimize", "scipy.spatial", "shapely", "trimesh",
)  # fmt: skip
"""Modules and packages that a check of boxes without friction does not need."""


def loaded_by(code: str) -> set[str]:
    """Names of the modules that a new process has loaded after running `code`."""
    listing = f"{code}\nimport sys\nprint(*sys.modules, file=sys.stderr)"
    ended = subprocess.run(
        [sys.executable, "-c", listing], capture_output=True, text=True, check=True, timeout=60
    )
    return set(ended.stderr.split())


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
    loaded = {name.partition(".")[0] for name in loaded_by(code)}
    assert "kilter" in loaded
    assert loaded & set(HEAVY) <= allowed


@pytest.mark.slow
def test_a_check_of_boxes_imports_no_module_that_it_does_not_need(tmp_path: Path) -> None:
    """The variables of the environment are those that a command sets for itself."""
    path = tmp_path / "a.kilter.json"
    boxes = [{"name": "a", "box": [1, 1, 1], "grounded": True}]
    boxes += [{"name": "b", "box": [1, 1, 1], "pose": {"position": [0.1, 0, 1]}}]
    path.write_text(json.dumps({"kilter": 1, "parts": boxes}), "utf-8")
    names = loaded_by(
        "import sys\nfrom kilter.cli import main\n"
        f"sys.argv = ['kilter', 'check', {str(path)!r}, '--quiet']\nmain()\n"
    )
    assert "kilter.analysis.check" in names
    assert names & set(UNUSED) == set()


@pytest.mark.slow
def test_numpy_lists_all_its_submodules_after_the_import_of_scipy() -> None:
    code = (
        "import numpy\nbefore = dir(numpy), numpy.__all__\n"
        "from kilter.cli.quick_scipy import import_scipy_quickly\nimport_scipy_quickly()\n"
        "assert (sorted(dir(numpy)), numpy.__all__) == (sorted(before[0]), before[1])\n"
        "import numpy.f2py, numpy.testing\n"
    )
    assert {"scipy.sparse", "numpy.f2py"} <= loaded_by(code)


@pytest.mark.parametrize("own", [True, False], ids=["own process", "process of a caller"])
def test_a_command_leaves_no_objects_to_the_collections_at_the_end_of_its_process(
    own: bool,
) -> None:
    code = (
        "import gc, sys\nfrom kilter.cli import main\nsys.argv = ['kilter', '--version']\n"
        f"main({'' if own else 'sys.argv[1:]'})\n"
        "print('frozen' if gc.get_freeze_count() else 'free', file=sys.stderr)\n"
    )
    assert ("frozen" in loaded_by(code)) == own
