"""`kilter doctor`: what is there, what answers as it must, and that what is broken is seen."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from kilter import health
from kilter.cli import main

SETTINGS = tomllib.loads((Path(__file__).resolve().parents[2] / "pyproject.toml").read_text())
FOR_OURSELVES = {"docs", "test", "browser", "notebook", "peers", "dev"}
"""Extras of who works on kilter."""


def package(requirement: str) -> str:
    return re.split(r"[\[<>=]", requirement)[0]


@pytest.mark.slow
def test_here_all_that_is_installed_works(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["doctor", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    looks = {look["name"]: look for look in answer["looks"]}
    assert answer["works"]
    assert {look["state"] for look in looks.values()} <= {"works", "absent"}
    assert set(looks) > {"kilter", "HiGHS", "Clarabel", "verdicts", "page", "terminal"}
    assert all(f"{name} " in looks["packages"]["found"] for name in health.NEEDED)
    for name in health.EXTRAS:
        absent = looks[name]["state"] == "absent"
        assert looks[name]["remedy"] == (f"pip install 'kilter[{name}]'" if absent else "")


def test_packages_and_extras_are_those_of_the_project() -> None:
    assert list(health.NEEDED) == [package(one) for one in SETTINGS["project"]["dependencies"]]
    extras = SETTINGS["project"]["optional-dependencies"]
    assert set(health.EXTRAS) == set(extras) - FOR_OURSELVES
    for name, (_, brought, _) in health.EXTRAS.items():
        assert package(extras[name][0]) == brought


@pytest.mark.parametrize("name", ["HiGHS", "Clarabel"])
def test_a_solver_that_answers_wrong_is_seen(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    from kilter.solvers import clarabel, highs

    home: ModuleType = highs if name == "HiGHS" else clarabel
    verb = "solve_linear" if name == "HiGHS" else "solve_conic"
    right = getattr(home, verb)

    def wrong(*given: object, **named: object) -> object:
        found = right(*given, **named)
        object.__setattr__(found, "x", np.asarray(found.x) * (1 + 1e-5))
        return found

    monkeypatch.setattr(home, verb, wrong)
    look = health._look(name, health._CHECKS[name])
    assert look.state == "broken"
    assert "optimal: [" in look.found


@pytest.mark.slow
def test_what_cannot_be_imported_is_broken_and_costs_no_other_look(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def lost(*given: object) -> None:
        raise ImportError("libhighs.so is not there")

    monkeypatch.setattr("kilter.solvers.highs.new_highs", lost)
    monkeypatch.setitem(health.EXTRAS, "figures", ("no_such_module", "none", "kilter draw"))
    assert main(["doctor"]) == 1
    first, _, *lines = capsys.readouterr().out.splitlines()
    assert first.startswith("kilter does not work here: HiGHS")
    rows = {line.split()[0]: line for line in lines}
    assert "broken  ImportError: libhighs.so is not there; install kilter again" in rows["HiGHS"]
    assert "works" in rows["Clarabel"]
    assert rows["figures"].endswith("absent  kilter draw; pip install 'kilter[figures]'")


def test_a_package_that_is_missing_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(health, "NEEDED", ("numpy", "no_such_module"))
    look = health._look("packages", health._packages)
    assert look.state == "broken"
    assert "no_such_module" in look.found
    assert "numpy" not in look.found


@pytest.mark.slow
def test_a_solid_of_another_volume_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("OCP")
    assert health._extra("step").state == "works"
    monkeypatch.setattr(health, "BALL", health.BALL.replace("#10,1.);", "#10,2.);"))
    look = health._extra("step")
    assert look.state == "broken"
    assert "ball of radius 1" in look.found
