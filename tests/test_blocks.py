"""Quick and slow cases, the blocks of the slow tests, and the tests of a source file."""

import subprocess
import sys
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import pytest

from near_tests import near_tests
from sampled import SLOW_EXAMPLES, in_block, mark_rest_slow, sampled

ROOT = Path(__file__).resolve().parents[1]


@pytest.mark.parametrize("case", range(6))
def test_cases_here(case):
    """Cases for the tests below."""


def cases(request: pytest.FixtureRequest) -> list[pytest.Item]:
    name = test_cases_here.__name__
    module = request.node.parent
    return [item for item in module.collect() if getattr(item, "originalname", "") == name]


def test_quick_chooses_cases_by_number_and_by_id(request):
    items = cases(request)
    for item in items:
        item.add_marker(pytest.mark.quick(2, "5"))
    mark_rest_slow(items)
    quick = [item.name for item in items if not item.get_closest_marker("slow")]
    assert quick == [f"test_cases_here[{k}]" for k in (0, 3, 5)]


def test_sampled_marks_all_but_the_first():
    first, *rest = sampled(1, 3)
    assert first == 0
    assert [case.values for case in rest] == [(1,), (2,)]
    assert all(case.marks[0].name == "slow" for case in rest)


@pytest.mark.parametrize("name", sorted(SLOW_EXAMPLES))
def test_slow_examples_are_in_docstrings(name):
    module, _, function = name.rpartition(".")
    assert ">>>" in getattr(import_module(module), function).__doc__


def test_every_test_is_in_one_block():
    items = [SimpleNamespace(nodeid=f"test_{k}") for k in range(40)]
    blocks = [in_block(items, f"{k}/3")[0] for k in (1, 2, 3)]  # type: ignore[arg-type]
    assert all(blocks)
    assert sorted(item.nodeid for block in blocks for item in block) == sorted(
        item.nodeid for item in items
    )


def test_slow_blocks_name_every_folder_of_tests():
    """The files beside the folders have an entry, too."""
    listing = ROOT / ".ci" / "slow_blocks"
    if not listing.exists():
        pytest.skip("the gate is not here")
    entries = [line.partition("#")[0].strip() for line in listing.read_text().splitlines()]
    listed = {name for entry in entries for name in entry.partition(":")[0].split(",")} - {""}
    folders = {path.parent.relative_to(ROOT).as_posix() for path in ROOT.glob("tests/*/test_*.py")}
    assert listed == folders | {"src", "tests/test_*.py"}


@pytest.mark.parametrize(("source", "nearest"), [
    ("mechanics/certificate.py", "analysis/test_certificates.py"),  # by guards.toml
    ("cli/file_commands.py", "cli/test_commands.py"),
    ("files/cad/step_process.py", "files/test_step"),
])  # fmt: skip
def test_a_source_file_has_its_nearest_tests(source, nearest):
    first, *others = near_tests(ROOT / "src/kilter" / source)
    assert first.as_posix().startswith(f"{ROOT.as_posix()}/tests/{nearest}")
    assert all(path.is_file() for path in others)


@pytest.mark.slow
def test_the_option_for_runs_them_and_the_examples_of_the_file():
    source = "src/kilter/shape/covering.py"
    run = [sys.executable, "-m", "pytest", "--for", source, "--collect-only"]
    listed = subprocess.run(run, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    assert "test_distances.py" in listed
