"""Read the densities that a STEP file states for its solids.

Three ways are in use (AP203 edition 2, AP214, AP242; CAx-IF, *Recommended Practices for Material
Identification and Density*):

    product definition <- PROPERTY_DEFINITION <- PROPERTY_DEFINITION_REPRESENTATION
    product definition <- MATERIAL_DESIGNATION <- MATERIAL_DESIGNATION_CHARACTERIZATION
    product definition <- MAKE_FROM_USAGE_OPTION -> product definition of a raw material, as above

All lead to a representation with a measure and its unit. Names of properties differ between
programs, so a measure counts as a density if its unit is a mass per volume. The text of the file is
searched: OCCT 7 and 8 convert only some units of densities.
"""

from __future__ import annotations

import math
import re
from collections import defaultdict
from collections.abc import Iterator
from typing import NamedTuple

# The entities of a STEP file as text, by number.


_ENTITY = re.compile(r"#(\d+)\s*=\s*((?:'[^']*'|[^;'])*);")
_NAME = re.compile(r"'[^']*'")
_STRING = re.compile(r"'((?:[^']|'')*)'")
_REFERENCE = re.compile(r"#(\d+)")
_CODED = re.compile(
    r"\\X2\\((?:[0-9A-F]{4})*)\\X0\\|\\X4\\((?:[0-9A-F]{8})*)\\X0\\"
    r"|\\X\\([0-9A-F]{2})|\\S\\(.)|(\\\\)|('')"
)
"""Codes of characters in a string of STEP (ISO 10303-21, 6.4.3)."""


class StepEntities:
    """The entities of a STEP file as text, by number.

    - `text`: definition of each entity, without its quoted names.
    - `of_type`: numbers of the entities of each type; a complex entity counts as its first type.
    """

    def __init__(self, data: bytes) -> None:
        try:
            decoded = data.decode("utf-8")
        except UnicodeDecodeError:
            decoded = data.decode("latin-1")
        self._whole = dict(_ENTITY.findall(decoded))
        self.text = {number: _NAME.sub("''", body) for number, body in self._whole.items()}
        self.of_type: dict[str, list[str]] = defaultdict(list)
        for number, body in self.text.items():
            self.of_type[body.lstrip("( \r\n").partition("(")[0].strip()].append(number)

    def references(self, number: str) -> list[str]:
        """Numbers of the entities that an entity refers to."""
        return _REFERENCE.findall(self.text.get(number, ""))

    def strings(self, number: str) -> list[str]:
        """The quoted strings of an entity, decoded."""
        return [_plain(string) for string in _STRING.findall(self._whole.get(number, ""))]

    def positions(self) -> dict[str, int]:
        """Position of each entity in the file; the first has 1, as in the model of OCCT."""
        return {number: k for k, number in enumerate(self.text, start=1)}

    def product(self, number: str) -> str:
        """The product definition of a shape of a product; any other entity itself."""
        is_shape = self.text.get(number, "").lstrip().startswith("PRODUCT_DEFINITION_SHAPE")
        return next(iter(self.references(number)), number) if is_shape else number

    def raw_materials(self) -> Iterator[tuple[str, str]]:
        """Yield product definitions and those of the raw materials of which they are made."""
        for number in self.of_type["MAKE_FROM_USAGE_OPTION"]:
            made, material = (*self.references(number), "", "")[:2]
            yield made, material

    def solids(self) -> Iterator[tuple[str, str]]:
        """Yield product definitions and the numbers of their solids."""
        related: dict[str, set[str]] = defaultdict(set)
        for number in self.of_type["SHAPE_REPRESENTATION_RELATIONSHIP"]:
            first, second = (*self.references(number), "", "")[:2]
            related[first].add(second)
            related[second].add(first)
        for number in self.of_type["SHAPE_DEFINITION_REPRESENTATION"]:
            shape, representation = (*self.references(number), "", "")[:2]
            for used in (representation, *related[representation]):
                for item in self.references(used):
                    if "BREP" in self.text.get(item, ""):
                        yield self.product(shape), item


def _plain(string: str) -> str:
    """A string of STEP with its coded characters replaced; unreadable codes stay."""

    def character(match: re.Match[str]) -> str:
        two, four, one, shifted, backslash, _ = match.groups()
        try:
            if two is not None:
                return bytes.fromhex(two).decode("utf-16-be")
            if four is not None:
                return bytes.fromhex(four).decode("utf-32-be")
        except UnicodeDecodeError:
            return match[0]
        if one is not None:
            return chr(int(one, 16))
        if shifted is not None:
            return chr(ord(shifted) + 128)
        return "\\" if backslash else "'"

    return _CODED.sub(character, string).strip()


_MEASURE = re.compile(r"MEASURE\s*\(\s*([-+.\dE]+)\s*\)\s*,\s*#(\d+)")
_EXPONENT = re.compile(r"#(\d+)\s*,\s*([-+.\dE]+)\s*\)")
_SI_UNIT = re.compile(r"SI_UNIT\s*\(\s*(?:\$|\.(\w+)\.)\s*,\s*\.(METRE|GRAM)\.")
_PREFIX = {
    "": 1.0,
    "KILO": 1e3,
    "DECI": 1e-1,
    "CENTI": 1e-2,
    "MILLI": 1e-3,
    "MICRO": 1e-6,
}
_BASE = {"METRE": (1.0, 0.0, 1.0), "GRAM": (1e-3, 1.0, 0.0)}
"""Size in SI units, and exponents of mass and of length, of the base units of STEP."""
_DENSITY = (1.0, -3.0)
"""Exponents of mass and of length of a density."""
_DENSITY_OF_OCCT = (3.0, 2.0)
"""The exponents that OCCT 7 and 8 write for g/cm^3; no other quantity has them."""
_LEVELS = 8
"""Largest number of conversions from a unit to an SI unit; ends references in a circle."""


class _Unit(NamedTuple):
    """Size of a unit in SI units (kg, m), and its exponents of mass and of length."""

    size: float
    mass: float
    length: float


def stated_densities(entities: StepEntities) -> dict[str, float]:
    """Densities that a STEP file states [kg/m^3], by the number of each solid.

    Stated values that are not positive, or without a unit of mass per volume, are left out.
    """
    return _Densities(entities).densities()


class _Densities:
    """Search for densities in the entities of a STEP file."""

    def __init__(self, entities: StepEntities) -> None:
        self.entities = entities

    def densities(self) -> dict[str, float]:
        """Density of each solid, by its number [kg/m^3]."""
        of_product = dict(self._of_products())
        for product, material in self.entities.raw_materials():
            if material in of_product:
                of_product.setdefault(product, of_product[material])
        return {
            solid: of_product[product]
            for product, solid in self.entities.solids()
            if product in of_product
        }

    def _of_products(self) -> Iterator[tuple[str, float]]:
        """Yield product definitions and their densities."""
        for number in self.entities.of_type["PROPERTY_DEFINITION_REPRESENTATION"]:
            yield from self._stated(number, self.entities.references(number)[:1])
        for number in self.entities.of_type["MATERIAL_DESIGNATION_CHARACTERIZATION"]:
            designation, *properties = self.entities.references(number)
            for material in properties[:1]:
                yield from self._stated(material, [designation])

    def _stated(self, representation: str, owners: list[str]) -> Iterator[tuple[str, float]]:
        """Yield the products of the owners with the density that a representation states."""
        for used in self.entities.references(representation):
            for item in self.entities.references(used):
                value = self._density(item)
                if value is not None:
                    targets = [to for owner in owners for to in self.entities.references(owner)]
                    yield from ((self.entities.product(target), value) for target in targets)

    def _density(self, item: str) -> float | None:
        """Value of a measure in kg/m^3; None if it is not a density."""
        measure = _MEASURE.search(self.entities.text.get(item, ""))
        unit = None if measure is None else self._unit(measure[2])
        if measure is None or unit is None or (unit.mass, unit.length) != _DENSITY:
            return None
        value = _number(measure[1]) * unit.size
        return value if 0 < value < math.inf else None

    def _unit(self, number: str, level: int = 0) -> _Unit | None:
        """The unit of an entity number; None if it cannot be read."""
        text = self.entities.text.get(number, "")
        if level > _LEVELS:
            return None
        if "DERIVED_UNIT" in text:
            return self._derived_unit(number, level)
        if "CONVERSION_BASED_UNIT" in text:
            for reference in self.entities.references(number):
                measure = _MEASURE.search(self.entities.text.get(reference, ""))
                base = None if measure is None else self._unit(measure[2], level + 1)
                if measure is not None and base is not None:
                    return base._replace(size=base.size * _number(measure[1]))
            return None
        unit = _SI_UNIT.search(text)
        if unit is None or (unit[1] or "") not in _PREFIX:
            return None
        size, mass, length = _BASE[unit[2]]
        return _Unit(size * _PREFIX[unit[1] or ""], mass, length)

    def _derived_unit(self, number: str, level: int) -> _Unit | None:
        """The product of the elements of a derived unit; None if one cannot be read."""
        elements = []
        for element in self.entities.references(number):
            power = _EXPONENT.search(self.entities.text.get(element, ""))
            unit = None if power is None else self._unit(power[1], level + 1)
            if power is None or unit is None:
                return None
            elements.append((unit, _number(power[2])))
        mass = sum(unit.mass * exponent for unit, exponent in elements)
        length = sum(unit.length * exponent for unit, exponent in elements)
        if (mass, length) == _DENSITY_OF_OCCT:
            mass, length = _DENSITY
            elements = [(unit, mass if unit.mass else length) for unit, _ in elements]
        return _Unit(math.prod(unit.size**exponent for unit, exponent in elements), mass, length)


def _number(word: str) -> float:
    """The value of a number in the text; NaN for other words."""
    try:
        return float(word)
    except ValueError:
        return math.nan
