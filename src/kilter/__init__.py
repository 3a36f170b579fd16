"""kilter: does an assembly of rigid parts stay together under gravity?

    import kilter

    assembly = kilter.load("arch.kilter.json")
    verdict = kilter.check(assembly)
    print(verdict.sentence, verdict.moving)

Everything public is imported when it is first used, so that ``import kilter`` stays light.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kilter.analysis.check import check
    from kilter.analysis.margins.margin import Margin, margin
    from kilter.analysis.regions.region import Region, common_region, region
    from kilter.analysis.turning.orientation import Orientation, orient
    from kilter.analysis.verdict import Verdict
    from kilter.assembly import Assembly, FrictionPair, GivenContact, Joint, Load, Part
    from kilter.contact import ContactSet, Tolerance, fastened, find_contacts
    from kilter.errors import InputError, KilterError, SolverError
    from kilter.files import dump, load
    from kilter.mechanics.verification import verify_proof
    from kilter.publish import Report, draw, report, view
    from kilter.rigid import Pose
    from kilter.scenes import scene
    from kilter.shape.primitives import Box, Cylinder, Mesh, Prism, Sphere

__version__ = "0.1.0"

_HOMES = {
    "Assembly": "kilter.assembly",
    "Box": "kilter.shape.primitives",
    "ContactSet": "kilter.contact",
    "Cylinder": "kilter.shape.primitives",
    "FrictionPair": "kilter.assembly",
    "GivenContact": "kilter.assembly",
    "InputError": "kilter.errors",
    "Joint": "kilter.assembly",
    "KilterError": "kilter.errors",
    "Load": "kilter.assembly",
    "Margin": "kilter.analysis.margins.margin",
    "Mesh": "kilter.shape.primitives",
    "Part": "kilter.assembly",
    "Pose": "kilter.rigid",
    "Orientation": "kilter.analysis.turning.orientation",
    "Prism": "kilter.shape.primitives",
    "Report": "kilter.publish",
    "Region": "kilter.analysis.regions.region",
    "SolverError": "kilter.errors",
    "Sphere": "kilter.shape.primitives",
    "Tolerance": "kilter.contact",
    "Verdict": "kilter.analysis.verdict",
    "check": "kilter.analysis.check",
    "common_region": "kilter.analysis.regions.region",
    "draw": "kilter.publish",
    "dump": "kilter.files",
    "fastened": "kilter.contact",
    "find_contacts": "kilter.contact",
    "load": "kilter.files",
    "margin": "kilter.analysis.margins.margin",
    "orient": "kilter.analysis.turning.orientation",
    "region": "kilter.analysis.regions.region",
    "report": "kilter.publish",
    "scene": "kilter.scenes",
    "verify_proof": "kilter.mechanics.verification",
    "view": "kilter.publish",
}

__all__ = [
    "Assembly",
    "Box",
    "ContactSet",
    "Cylinder",
    "FrictionPair",
    "GivenContact",
    "InputError",
    "Joint",
    "KilterError",
    "Load",
    "Margin",
    "Mesh",
    "Orientation",
    "Part",
    "Pose",
    "Prism",
    "Region",
    "Report",
    "SolverError",
    "Sphere",
    "Tolerance",
    "Verdict",
    "check",
    "common_region",
    "draw",
    "dump",
    "fastened",
    "find_contacts",
    "load",
    "margin",
    "orient",
    "region",
    "report",
    "scene",
    "verify_proof",
    "view",
]


def __getattr__(name: str) -> Any:
    try:
        home = _HOMES[name]
    except KeyError:
        raise AttributeError(f"module 'kilter' has no attribute {name!r}") from None
    return getattr(importlib.import_module(home), name)


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])
