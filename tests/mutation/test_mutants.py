"""Mutants themselves: what is made of a few lines, and that one is seen by a test and put back."""

import ast
import tomllib
from pathlib import Path

import pytest
from mutants import mutants

HERE = Path(__file__).resolve().parent
SOURCE = '''
def decides(power: float, least: float = 0.5) -> bool:
    """Words stay as they are."""
    assert power
    return power > least and not (power + 1) is None
'''


def test_every_mutant_is_one_change_and_runs():
    found = {one.name.removeprefix("decides: "): one for one in mutants(SOURCE)}
    assert set(found) == {
        "power > least -> power >= least",
        "power > least -> power <= least",
        "power > least and (not power + 1 is None) -> power > least or not power + 1 is None",
        "not power + 1 is None -> power + 1 is None",
        "power + 1 is None -> power + 1 is not None",
        "power + 1 -> power - 1",
        "1 -> 2",
        "0.5 -> 1.5",
        "return power > least and (not power + 1 is None) -> return",
    }
    for one in found.values():
        scope: dict[str, object] = {}
        exec(one.code(Path("decides.py")), scope)
        assert callable(scope["decides"])
        assert ast.unparse(one.tree) != ast.unparse(ast.parse(SOURCE))


@pytest.mark.slow
def test_reasons_are_of_modules_and_mutants_that_are_there():
    guards = tomllib.loads((HERE / "guards.toml").read_text(encoding="utf-8"))
    reasons = tomllib.loads((HERE / "survivors.toml").read_text(encoding="utf-8"))
    assert set(reasons) <= set(guards)
    for module, tests in guards.items():
        path = HERE.parents[1] / "src" / (module.replace(".", "/") + ".py")
        every = {one.name for one in mutants(path.read_text(encoding="utf-8"))}
        assert set(reasons.get(module, {})) <= every
        assert len(reasons.get(module, {})) <= 0.05 * len(every)
        assert all((HERE.parents[1] / test).exists() for test in tests)
