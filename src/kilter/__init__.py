"""kilter: does an assembly of rigid parts stay together under gravity?

    import kilter

    assembly = kilter.load("arch.kilter.json")
    verdict = kilter.check(assembly)
    print(verdict.sentence, verdict.moving)

Each command of ``kilter`` is also a function of the same name. A public name is imported at its
first use, so that ``import kilter`` is fast.
"""

from __future__ import annotations

import importlib
from functools import partial
from typing import TYPE_CHECKING, Any

from kilter import hooks

if TYPE_CHECKING:
    from kilter.analysis.check import check as check
    from kilter.analysis.many.batch import Batch as Batch
    from kilter.analysis.many.batch import batch as batch
    from kilter.analysis.many.check_many import check_many as check_many
    from kilter.analysis.many.verdicts import Verdicts as Verdicts
    from kilter.analysis.margins.improve import Improvement as Improvement
    from kilter.analysis.margins.improve import improve as improve
    from kilter.analysis.margins.margin import margin as margin
    from kilter.analysis.margins.margin_answer import Margin as Margin
    from kilter.analysis.placing.check_plan import CheckedPlan as CheckedPlan
    from kilter.analysis.placing.check_plan import check_plan as check_plan
    from kilter.analysis.placing.piles.pile import Pile as Pile
    from kilter.analysis.placing.piles.pile import PileFit as PileFit
    from kilter.analysis.placing.place import Places as Places
    from kilter.analysis.placing.place import box_to_place as box_to_place
    from kilter.analysis.placing.place import place as place
    from kilter.analysis.planning.hold.fixture import Fixture as Fixture
    from kilter.analysis.planning.hold.hold import hold as hold
    from kilter.analysis.planning.order.order import Order as Order
    from kilter.analysis.planning.order.plan import plan as plan
    from kilter.analysis.planning.order.plan_rules import PlanRules as PlanRules
    from kilter.analysis.planning.order.plan_step import Step as Step
    from kilter.analysis.planning.states.state import State as State
    from kilter.analysis.planning.states.states import States as States
    from kilter.analysis.planning.states.states import states as states
    from kilter.analysis.regions.region import Region as Region
    from kilter.analysis.regions.region import common_region as common_region
    from kilter.analysis.regions.region import region as region
    from kilter.analysis.scene_states.object_states import scene as scene
    from kilter.analysis.scene_states.scene_report import SceneObject as SceneObject
    from kilter.analysis.scene_states.scene_report import SceneReport as SceneReport
    from kilter.analysis.settled_pose.settle import Settled as Settled
    from kilter.analysis.settled_pose.settle import settle as settle
    from kilter.analysis.transport.carrier import CarrierMotion as CarrierMotion
    from kilter.analysis.transport.carrier_path import CarrierPath as CarrierPath
    from kilter.analysis.transport.transport import transport as transport
    from kilter.analysis.transport.transport_answer import Transport as Transport
    from kilter.analysis.turning.orientation import Orientation as Orientation
    from kilter.analysis.turning.orientation import orient as orient
    from kilter.analysis.verdict.part_answer import PartAnswer as PartAnswer
    from kilter.analysis.verdict.part_answer import PointForces as PointForces
    from kilter.analysis.verdict.verdict import Verdict as Verdict
    from kilter.analysis.verification import Verification as Verification
    from kilter.analysis.verification import verify as verify
    from kilter.assembly.assembly import Assembly as Assembly
    from kilter.assembly.assembly_arrays import AssemblyArrays as AssemblyArrays
    from kilter.assembly.bonds import Bond as Bond
    from kilter.assembly.feature import Feature as Feature
    from kilter.assembly.interactions import FrictionPair as FrictionPair
    from kilter.assembly.interactions import GivenContact as GivenContact
    from kilter.assembly.interactions import Joint as Joint
    from kilter.assembly.interactions import Load as Load
    from kilter.assembly.part import Part as Part
    from kilter.assembly.straps import Strap as Strap
    from kilter.contact.common.gaps import Tolerance as Tolerance
    from kilter.contact.common.patches import Patch as Patch
    from kilter.contact.contact_set import ContactSet as ContactSet
    from kilter.contact.detect import contacts as contacts
    from kilter.contact.fits.choices_saving import save as save
    from kilter.contact.fits.fastening import fastened as fastened
    from kilter.contact.supports import Support as Support
    from kilter.errors import InputError as InputError
    from kilter.errors import KilterError as KilterError
    from kilter.errors import SolverError as SolverError
    from kilter.files.answer_files import LoadedAnswer as LoadedAnswer
    from kilter.files.answer_files import load_answer as load_answer
    from kilter.files.choices import Choices as Choices
    from kilter.files.reading import load as load
    from kilter.files.writing import dump as dump
    from kilter.health import Health as Health
    from kilter.health import doctor as doctor
    from kilter.notebook import Shown as Shown
    from kilter.publish.answer_figures import draw as draw
    from kilter.publish.films import animate as animate
    from kilter.publish.offline_page import Report as Report
    from kilter.publish.offline_page import report as report
    from kilter.rigid import Pose as Pose
    from kilter.scenes import example as example
    from kilter.scenes.registry import Example as Example
    from kilter.shape.primitives import Box as Box
    from kilter.shape.primitives import Cylinder as Cylinder
    from kilter.shape.primitives import Mesh as Mesh
    from kilter.shape.primitives import Prism as Prism
    from kilter.shape.primitives import Sphere as Sphere
    from kilter.tell.levels import VerdictWord as VerdictWord
    from kilter.workbench.view import view as view

__version__ = "0.1.0"

_HOMES = {
    # functions of the commands
    "batch": "kilter.analysis.many.batch",
    "check": "kilter.analysis.check",
    "check_plan": "kilter.analysis.placing.check_plan",
    "contacts": "kilter.contact.detect",
    "doctor": "kilter.health",
    "draw": "kilter.publish.answer_figures",
    "dump": "kilter.files.writing",
    "example": "kilter.scenes",
    "hold": "kilter.analysis.planning.hold.hold",
    "improve": "kilter.analysis.margins.improve",
    "load": "kilter.files.reading",
    "margin": "kilter.analysis.margins.margin",
    "orient": "kilter.analysis.turning.orientation",
    "place": "kilter.analysis.placing.place",
    "plan": "kilter.analysis.planning.order.plan",
    "region": "kilter.analysis.regions.region",
    "report": "kilter.publish.offline_page",
    "save": "kilter.contact.fits.choices_saving",
    "scene": "kilter.analysis.scene_states.object_states",
    "settle": "kilter.analysis.settled_pose.settle",
    "transport": "kilter.analysis.transport.transport",
    "verify": "kilter.analysis.verification",
    "view": "kilter.workbench.view",
    # further functions
    "animate": "kilter.publish.films",
    "box_to_place": "kilter.analysis.placing.place",
    "check_many": "kilter.analysis.many.check_many",
    "common_region": "kilter.analysis.regions.region",
    "load_answer": "kilter.files.answer_files",
    "fastened": "kilter.contact.fits.fastening",
    "states": "kilter.analysis.planning.states.states",
    # types of their arguments
    "Assembly": "kilter.assembly.assembly",
    "AssemblyArrays": "kilter.assembly.assembly_arrays",
    "Box": "kilter.shape.primitives",
    "Choices": "kilter.files.choices",
    "Cylinder": "kilter.shape.primitives",
    "Feature": "kilter.assembly.feature",
    "FrictionPair": "kilter.assembly.interactions",
    "GivenContact": "kilter.assembly.interactions",
    "Bond": "kilter.assembly.bonds",
    "CarrierMotion": "kilter.analysis.transport.carrier",
    "CarrierPath": "kilter.analysis.transport.carrier_path",
    "Joint": "kilter.assembly.interactions",
    "Load": "kilter.assembly.interactions",
    "Mesh": "kilter.shape.primitives",
    "Part": "kilter.assembly.part",
    "Strap": "kilter.assembly.straps",
    "Pose": "kilter.rigid",
    "Prism": "kilter.shape.primitives",
    "Sphere": "kilter.shape.primitives",
    "Support": "kilter.contact.supports",
    "Tolerance": "kilter.contact.common.gaps",
    # types of their results
    "Batch": "kilter.analysis.many.batch",
    "ContactSet": "kilter.contact.contact_set",
    "CheckedPlan": "kilter.analysis.placing.check_plan",
    "Example": "kilter.scenes.registry",
    "Fixture": "kilter.analysis.planning.hold.fixture",
    "Health": "kilter.health",
    "Improvement": "kilter.analysis.margins.improve",
    "LoadedAnswer": "kilter.files.answer_files",
    "Margin": "kilter.analysis.margins.margin_answer",
    "Order": "kilter.analysis.planning.order.order",
    "PartAnswer": "kilter.analysis.verdict.part_answer",
    "Patch": "kilter.contact.common.patches",
    "Pile": "kilter.analysis.placing.piles.pile",
    "PileFit": "kilter.analysis.placing.piles.pile",
    "Places": "kilter.analysis.placing.place",
    "PointForces": "kilter.analysis.verdict.part_answer",
    "PlanRules": "kilter.analysis.planning.order.plan_rules",
    "Orientation": "kilter.analysis.turning.orientation",
    "Region": "kilter.analysis.regions.region",
    "Report": "kilter.publish.offline_page",
    "SceneObject": "kilter.analysis.scene_states.scene_report",
    "SceneReport": "kilter.analysis.scene_states.scene_report",
    "Settled": "kilter.analysis.settled_pose.settle",
    "Shown": "kilter.notebook",
    "State": "kilter.analysis.planning.states.state",
    "States": "kilter.analysis.planning.states.states",
    "Transport": "kilter.analysis.transport.transport_answer",
    "Step": "kilter.analysis.planning.order.plan_step",
    "Verdict": "kilter.analysis.verdict.verdict",
    "VerdictWord": "kilter.tell.levels",
    "Verdicts": "kilter.analysis.many.verdicts",
    "Verification": "kilter.analysis.verification",
    # exceptions
    "InputError": "kilter.errors",
    "KilterError": "kilter.errors",
    "SolverError": "kilter.errors",
}
"""Module of each public name."""

__all__ = sorted(_HOMES)


_HOOKS = {
    "cell": "kilter.notebook",
    "load": "kilter.files.reading",
    "mass_of": "kilter.assembly.geometry",
    "read_chosen": "kilter.contact.fits.chosen",
    "scene_of": "kilter.files.objects.trimesh_objects",
    "settle_remedy": "kilter.analysis.settled_pose.settle_remedy",
    "to_mjcf": "kilter.files.mjcf",
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
