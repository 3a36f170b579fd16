"""A file that stays read while the choices about it change.

The content of the file and the findings of the contact search are kept. A change of held parts,
joints, friction, masses, loads or gravity needs neither, and neither do parts that are left out.
The assembly and the contacts are equal to those that `kilter check` reads from the saved choices.
"""

from __future__ import annotations

import fnmatch
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.assembly.question import supported
from kilter.contact import ContactSet, Tolerance
from kilter.contact.fits.fastening import fasten_as_read
from kilter.contact.kept_contacts import KeptContacts
from kilter.files.file_content import FileContent
from kilter.files.own.choices import Choices
from kilter.files.reading import Chosen, chosen
from kilter.loading import tolerance_of
from kilter.units import metres_per_unit

# The parts of an opened file, as far as the actions of a user need them.


@dataclass(frozen=True, slots=True)
class OpenedParts:
    """Names of the parts of a file, and properties of each part."""

    names: tuple[str, ...] = ()
    """Parts of the file, also those that the choices leave out; without a floor."""
    held: frozenset[str] = frozenset()
    """Parts that the file itself holds; no choice releases them."""
    volume: tuple[float, ...] = ()
    """Volume of each part [m^3]."""

    def matching(self, patterns: Sequence[str]) -> list[str]:
        """Parts that any of the patterns names or matches, in the order of the file."""
        exact = set(patterns)
        globs = [pattern for pattern in patterns if pattern not in self.names]
        return [
            name
            for name in self.names
            if name in exact or any(fnmatch.fnmatchcase(name, glob) for glob in globs)
        ]

    def volume_of(self, name: str) -> float:
        """Volume of a part [m^3]; 0 for a part that the file does not have."""
        return self.volume[self.names.index(name)] if name in self.names else 0.0


Tell = Callable[[str], None]


@dataclass(frozen=True, slots=True, eq=False)
class Prepared:
    """An assembly as the choices describe it, with its contacts."""

    assembly: Assembly
    contacts: ContactSet
    tolerance: Tolerance
    left_out: tuple[str, ...]
    """Parts of the file that the choices leave out."""
    moved: bool = False
    """Whether parts are in other poses than the file and the choices state."""


class LiveAssembly:
    """A file whose content and contacts are kept for the next choices."""

    def __init__(self, path: Path, progress: Tell | None = None) -> None:
        self.path = path
        self.progress = progress or (lambda stage: None)
        self._content: tuple[Any, FileContent] | None = None
        self._kept: list[KeptContacts] = []

    def opened_parts(self, keys: dict[str, Any]) -> OpenedParts:
        """The parts of the file, read with the options of choices.

        Raises `InputError` if the file cannot be read.
        """
        _, content = self._read(self._chosen(keys))
        assembly = content.assembly
        metre = metres_per_unit(assembly.units)
        return OpenedParts(
            assembly.names,
            frozenset(part.name for part in assembly.parts if part.grounded),
            tuple((assembly.geometry.volume * metre**3).tolist()),
        )

    def gravity(self, keys: dict[str, Any]) -> Array:
        """Acceleration of gravity with the options of choices, shape (3,) [m/s^2]."""
        both = self._chosen(keys)
        return np.asarray(both.reading.read_content(self._read(both)[1]).gravity)

    def prepare(self, keys: dict[str, Any], verb: str = "check") -> Prepared:
        """The assembly and the contacts for the given choices.

        If nothing is held, the support is that which the question `verb` assumes.

        Raises `InputError` if the choices are invalid, or the file cannot be read.
        """
        both = self._chosen(keys)
        tolerance = tolerance_of(both.choices)
        _, content = self._read(both)
        assembly = both.reading.read_content(content)
        notes = [*assembly.notes, *both.notes]
        reading = both.reading.options()
        assembly = replace(assembly, notes=notes, tolerance=tolerance, reading=reading)
        assembly = supported(assembly, verb)

        def find(changed: Assembly) -> ContactSet:
            return self._contacts(changed, tolerance, content)

        joined, contacts = fasten_as_read(assembly, both.reading, tolerance=tolerance, find=find)
        if contacts is None:
            contacts = find(joined)
        here = set(joined.names)
        left_out = tuple(name for name in content.assembly.names if name not in here)
        return Prepared(joined, contacts, tolerance, left_out)

    def _chosen(self, keys: dict[str, Any]) -> Chosen:
        return chosen(Choices.from_dict(keys, folder=self.path.parent))

    def _read(self, both: Chosen) -> tuple[Any, FileContent]:
        """The content of the file; it is read again if the file or the reading options changed."""
        whole = replace(both.reading, without=())
        key = (both.reading.entries["sha256"], whole.format_options)
        if self._content is None or self._content[0] != key:
            self._content = key, whole.content(self.path, progress=self.progress)
            self._kept.clear()
        return self._content

    def _contacts(
        self, assembly: Assembly, tolerance: Tolerance, content: FileContent
    ) -> ContactSet:
        """The contacts of an assembly, from kept findings if they serve it."""
        for kept in self._kept:
            if kept.serves(assembly, tolerance):
                return kept.contacts(assembly)
        held = {part.name for part in content.assembly.parts if part.grounded}
        kept = KeptContacts.find(assembly, tolerance, held=held, progress=self.progress)
        # findings of the latest searches, for undo: with and without a floor, other tolerances
        self._kept = [kept, *self._kept[: KEPT - 1]]
        return kept.contacts(assembly)


KEPT = 3
"""Number of contact searches whose findings are kept; more need more memory."""


# Densities of common materials that the workbench offers, with their sources [kg/m^3].


@dataclass(frozen=True, slots=True)
class Material:
    """A material with its density [kg/m^3] and the source of this number."""

    name: str
    density: float
    source: str


USUAL = "usual value of data sheets"

MATERIALS = (
    Material("steel", 7850, "EN 1993-1-2, 3.2.2"),
    Material("stainless steel", 7900, "EN 10088-1, steel 1.4301"),
    Material("cast iron", 7200, USUAL),
    Material("aluminium", 2700, "EN 1999-1-1, 3.2.5"),
    Material("brass", 8500, USUAL),
    Material("copper", 8900, USUAL),
    Material("concrete", 2400, USUAL),
    Material("granite", 2700, USUAL),
    Material("limestone", 2300, USUAL),
    Material("brick", 1800, USUAL),
    Material("oak", 700, USUAL),
    Material("spruce", 420, "EN 338, class C24, mean density"),
    Material("glass", 2500, "EN 572-1"),
    Material("ABS", 1040, USUAL),
    Material("PLA", 1240, USUAL),
    Material("nylon", 1140, USUAL),
    Material("rubber", 1200, USUAL),
)
"""Materials in the order of the list that the page shows."""
