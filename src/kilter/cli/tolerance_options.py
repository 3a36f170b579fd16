"""The options of the contact tolerance, and straps of a file."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kilter.errors import InputError
from kilter.files.reading_options import TOUCH
from kilter.values.declaration import option

if TYPE_CHECKING:
    from kilter.contact import Tolerance
    from kilter.files.choices import Choices

__all__ = ["ToleranceOptions", "straps_of"]


@dataclass(frozen=True, kw_only=True)
class ToleranceOptions:
    """Values of the tolerance options of a command; None or False for options not given."""

    gap: float | None = option(
        "--gap LENGTH",
        "Largest gap between touching faces (file units); 1e-5 of the size of the smaller "
        "part by default.",
        TOUCH,
    )
    angle: float | None = option(
        "--angle DEG",
        "Largest angle between touching faces [deg]; 0.057 deg (1e-3 rad) by default.",
        TOUCH,
    )
    clearance: float | None = option(
        "--clearance LENGTH",
        "Designed clearance: faces up to this distance apart (file units) count as closed. "
        "Penetrating faces do not.",
        TOUCH,
    )
    loose: bool = option(
        "--loose",
        "For scanned or rounded data: touching faces may have gaps up to 1e-3 of the size of "
        "the smaller part and angles up to 1.15 deg.",
        TOUCH,
    )

    def tolerance(self) -> Tolerance:
        """The contact tolerance for these option values.

        Raises `InputError` if a value is not positive, or the angle [deg] is 45 or more.
        """
        from kilter.contact import Tolerance

        base = Tolerance.loose() if self.loose else Tolerance()
        for name, value in (("gap", self.gap), ("clearance", self.clearance)):
            if value is not None and not (math.isfinite(value) and value > 0):
                raise InputError(
                    f"--{name} is {value:g}", hint="give a length above zero, in file units"
                )
        angle = self.angle
        if angle is not None and not (math.isfinite(angle) and 0 < angle < 45):
            raise InputError(f"--angle is {angle:g}", hint="give an angle between 0 and 45 degrees")
        return Tolerance(
            gap=self.gap,
            relative_gap=base.relative_gap,
            angle=base.angle if angle is None else math.radians(angle),
            clearance=self.clearance,
        )

    def words(self) -> list[str]:
        """The tolerance options as words of a command line."""
        words = [
            word
            for name in ("gap", "angle", "clearance")
            if getattr(self, name) is not None
            for word in (f"--{name}", f"{getattr(self, name):.15g}")
        ]
        return [*words, "--loose"] if self.loose else words

    def saved(self) -> dict[str, Any]:
        """The tolerance options as keys of a file of choices."""
        values = {"gap": self.gap, "angle_deg": self.angle, "clearance": self.clearance}
        return {"tolerance": values, "loose": self.loose}

    def over(self, choices: Choices) -> tuple[ToleranceOptions, list[str]]:
        """These options completed by a file of choices, and a sentence for each replaced value."""
        kept = dict(choices.tolerance or {})
        kept["angle"] = kept.pop("angle_deg", None)
        replaced = []
        for name in ("gap", "angle", "clearance"):
            value, old = getattr(self, name), kept.get(name)
            if value is not None and old not in (None, value):
                replaced.append(
                    f"the option {name} {value:.15g} replaces {name} {old:.15g} of the choices"
                )
            kept[name] = old if value is None else value
        return ToleranceOptions(**kept, loose=self.loose or choices.loose), replaced


def straps_of(path: Path) -> dict[str, Any]:
    """Read the file of ``--straps`` as entries of a reading: a JSON list of straps.

    Raises `InputError` if the file cannot be read, or an entry is no strap.
    """
    from kilter.files.raw import read_bytes
    from kilter.files.saved_entries import valid_entries
    from kilter.files.strict_json import parse_json

    try:
        data = parse_json(read_bytes(path))
        if not isinstance(data, list) or not data:
            raise InputError(
                "this is no list of straps",
                hint='write [{"path": [["ground", [x, y, z]], ["box", [x, y, z]]], "tension": N}]',
            )
        return valid_entries({"straps": data})
    except InputError as error:
        raise error.located(file=str(path)) from None
