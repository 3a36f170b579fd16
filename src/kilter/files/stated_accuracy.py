"""Read the coordinate accuracy that a STEP file states.

    #15 = UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(0.01), #12, 'distance_accuracy_value', ...)

The value is in the unit #12: an SI unit with a prefix, or a unit that is defined by a conversion
(inch). Every shape may state a value; the largest counts. The text of the file is searched, since
OCCT merges the value into the tolerances of edges.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from kilter.units import METRES

__all__ = ["stated_accuracy"]

_STATED = re.compile(
    r"UNCERTAINTY_MEASURE_WITH_UNIT\s*\(\s*LENGTH_MEASURE\s*\(\s*([^()\s]+)\s*\)\s*,\s*#(\d+)"
)
_PREFIX = {"MILLI": 1e-3, "CENTI": 1e-2, "DECI": 1e-1, "MICRO": 1e-6, "KILO": 1e3}
_SI = re.compile(r"SI_UNIT\s*\(\s*(?:\$|\.(\w+)\.)\s*,\s*\.METRE\.")
_CONVERTED = re.compile(r"CONVERSION_BASED_UNIT\s*\(\s*'([^']*)'", re.IGNORECASE)
_NAMED = {"INCH": 0.0254, "FOOT": 0.3048, "MILLIMETRE": 1e-3, "MILLIMETER": 1e-3}


def stated_accuracy(paths: Iterable[Path], units: str) -> float:
    """Largest coordinate error that STEP files state, in the unit `units`; 0 if none is stated."""
    largest = 0.0
    for path in paths:
        try:
            text = path.read_bytes().decode("latin-1")
        except OSError:
            continue
        for number, unit in set(_STATED.findall(text)):
            metres = _metres(text, unit)
            if metres is not None:
                largest = max(largest, _number(number) * metres / METRES[units])
    return largest


def _number(word: str) -> float:
    """The value of a word that is a positive finite number; 0 for other words."""
    try:
        value = float(word)
    except ValueError:
        return 0.0
    return value if 0 < value < np.inf else 0.0


def _metres(text: str, unit: str) -> float | None:
    """Size in metres of the length unit with an entity number; None if it cannot be read."""
    defined = re.search(rf"#{unit}\s*=([^;]*);", text)
    if defined is None:
        return None
    converted = _CONVERTED.search(defined[1])
    if converted is not None:
        return _NAMED.get(converted[1].strip().upper())
    si = _SI.search(defined[1])
    return None if si is None else _PREFIX.get(si[1] or "", None if si[1] else 1.0)
