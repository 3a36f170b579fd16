"""kilter: does an assembly of rigid parts stay together under gravity?

    import kilter

    assembly = kilter.load("arch.kilter.json")
    verdict = kilter.check(assembly)
    print(verdict.sentence, verdict.moving)

Each command of ``kilter`` is also a function of the same name. A public name is imported at its
first use, so that ``import kilter`` is fast. `docs/build_stub.py` writes what type checkers see.
"""

from __future__ import annotations

import importlib
from functools import partial
from typing import Any

from kilter import hooks

__version__ = "0.1.0"

_NAMES = {
    "kilter.analysis.check": "check",
    "kilter.analysis.engine_contacts.given_contacts": "check_contacts",
    "kilter.analysis.engine_contacts.judged": "Judged judge",
    "kilter.analysis.many.batch": "Batch batch",
    "kilter.analysis.many.settle_states": "SettledStates settle_states",
    "kilter.analysis.many.check_many": "check_many",
    "kilter.analysis.many.verdicts": "Verdicts",
    "kilter.analysis.margins.margin": "margin",
    "kilter.analysis.margins.margin_answer": "Margin",
    "kilter.analysis.margins.parameter_limit": "ParameterLimit limit",
    "kilter.analysis.placing.check_plan": "CheckedPlan check_plan",
    "kilter.analysis.placing.piles.pile": "Pile PileFit",
    "kilter.analysis.placing.place": "Places box_to_place place",
    "kilter.analysis.planning.hold.fixture": "Fixture",
    "kilter.analysis.planning.hold.hold": "hold",
    "kilter.analysis.planning.order.order": "Order",
    "kilter.analysis.planning.order.plan": "plan",
    "kilter.analysis.planning.order.plan_rules": "PlanRules",
    "kilter.analysis.planning.order.plan_step": "Step",
    "kilter.analysis.planning.states.known_proofs": "State",
    "kilter.analysis.planning.states.states": "States states",
    "kilter.analysis.regions.region": "Region common_region region",
    "kilter.analysis.scene_states.object_states": "scene",
    "kilter.analysis.scene_states.scene_report": "SceneObject SceneReport",
    "kilter.analysis.settled_pose.settle": "Settled settle",
    "kilter.analysis.transport.carrier": "CarrierMotion",
    "kilter.analysis.transport.carrier_path": "CarrierPath",
    "kilter.analysis.transport.transport": "transport",
    "kilter.analysis.transport.transport_answer": "Transport",
    "kilter.analysis.turning.orientation": "Orientation orient",
    "kilter.analysis.verdict.part_answer": "PartAnswer PointForces",
    "kilter.analysis.verdict.verdict": "Verdict",
    "kilter.analysis.verification": "Verification verify",
    "kilter.assembly.assembly": "Assembly",
    "kilter.assembly.assembly_arrays": "AssemblyArrays",
    "kilter.assembly.bonds": "Bond",
    "kilter.assembly.feature": "Feature",
    "kilter.assembly.interactions": "FrictionPair GivenContact Joint Load",
    "kilter.assembly.part": "Part",
    "kilter.assembly.straps": "Strap",
    "kilter.contact.contact_set": "ContactSet",
    "kilter.contact.detect": "contacts",
    "kilter.contact.fits.fastening": "fastened",
    "kilter.contact.common.gaps": "Tolerance",
    "kilter.contact.common.patches": "Patch",
    "kilter.contact.supports": "Support",
    "kilter.errors": "InputError KilterError SolverError",
    "kilter.files.own.answer_files": "LoadedAnswer load_answer",
    "kilter.files.own.choices": "Choices",
    "kilter.files.writing": "dump",
    "kilter.loading": "load save",
    "kilter.health": "Health doctor",
    "kilter.notebook": "Shown",
    "kilter.publish.answer_figures": "draw",
    "kilter.publish.films": "animate",
    "kilter.publish.offline_page": "Report report",
    "kilter.rigid": "Pose",
    "kilter.scenes": "example",
    "kilter.scenes.registry": "Example",
    "kilter.shape.primitives": "Box Cylinder Mesh Prism Sphere",
    "kilter.tell.levels": "VerdictWord",
    "kilter.workbench.server": "view",
}
"""Public names of each module."""
_HOMES = {name: home for home, names in _NAMES.items() for name in names.split()}
"""Module of each public name."""
__all__ = sorted(_HOMES)


_HOOKS = {
    "assumed": "kilter.analysis.assumptions.rung_verdict",
    "ladder": "kilter.analysis.assumptions.rung_verdict",
    "better_up": "kilter.analysis.assumptions.upward",
    "bodies_of": "kilter.analysis.assumptions.joined_bodies",
    "cell": "kilter.notebook",
    "copies": "kilter.contact.fits.copies",
    "landings": "kilter.analysis.settled_pose.straight_falls",
    "load": "kilter.loading",
    "mass_of": "kilter.assembly.geometry",
    "parameter_figure": "kilter.show.parameter_figure",
    "scene_of": "kilter.files.objects.trimesh_objects",
    "to_mjcf": "kilter.files.robots.mjcf",
    "verdict_on_rung": "kilter.analysis.assumptions.rung_verdict",
}
"""Module of each function that lower packages call through `kilter.hooks`."""


def _attribute(home: str, name: str) -> Any:
    """The value of a name of a module, which is imported now."""
    return getattr(importlib.import_module(home), name)


for _name, _home in _HOOKS.items():
    hooks.register(_name, partial(_attribute, _home, _name))


def __getattr__(name: str) -> Any:
    try:
        home = _HOMES[name]
    except KeyError:
        words = f"module 'kilter' has no attribute {name!r}"
        guesses = importlib.import_module("kilter.values.guesses")
        remedy = guesses.remedy_of("kilter", name)
        if remedy is not None:
            raise guesses.GuessedAttribute(words, hint=remedy) from None
        raise AttributeError(words) from None
    return _attribute(home, name)


def __dir__() -> list[str]:
    return sorted([*_HOMES, "__version__"])
