"""The entities of a STEP file as text, by number.

OCCT leaves out some facts, or converts only some forms of them, so they are read from the text.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator

__all__ = ["StepEntities"]

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
