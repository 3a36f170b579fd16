"""Pydantic model of a file of choices: its keys and their types.

The module is imported only when choices are validated, since importing pydantic is slow. Values
such as the name of an axis are verified by `kilter.files.reading.Reading`.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field

from kilter.files.models import (
    BondEntry,
    Entry,
    Flag,
    FrictionPairEntry,
    JointEntry,
    LoadEntry,
    Name,
    NotNegative,
    Number,
    Pair,
    PoseEntry,
    Positive,
    StrapEntry,
    Vector,
)

__all__ = ["ChoicesFile", "build_choices_schema"]


class StudsEntry(Entry):
    """Rules for toy bricks: strength of the studs, and contact points between brick sides."""

    pull: NotNegative | None = Field(None, description="[N]")
    shear: NotNegative | Literal["unlimited", "mu"] | None = Field(None, description="[N]")
    sides: Literal["lower-edge", "face", "none"] | None = None


class OpenPairEntry(Entry):
    """Decision on two parts of which the geometry does not show whether they touch."""

    parts: Pair
    state: Literal["joined", "touching", "apart"] = Field(alias="as")


class MaterialEntry(Entry):
    """Material of the parts that match a pattern; its density replaces the mass in the file."""

    parts: Name = Field(description="a name; * and ? are wildcards")
    density: Positive = Field(description="[kg/m^3]")
    name: Name | None = Field(None, description="name of the material")


class ToleranceEntry(Entry):
    """Tolerances with which faces count as touching; null: the default."""

    gap: Positive | None = Field(None, description="[length unit]")
    angle_deg: Annotated[Positive, Field(lt=45)] | None = Field(None, description="[deg]")
    clearance: Positive | None = Field(None, description="[length unit]")


class ChoicesFile(Entry):
    """The choices of a user about a file: held parts, joined parts, friction and so on."""

    model_config = ConfigDict(extra="forbid", title="kilter choices")

    kilter: Literal[1]
    file: Name = Field(description="the file, relative to the choices, in their folder or below")
    sha256: Annotated[str, Field(strict=True, pattern="^[0-9a-f]{64}$")] | None = Field(
        None, description="digest of the file, for a warning if it changes"
    )
    units: Literal["m", "cm", "mm", "in"] | None = None
    up: Literal["x", "y", "z", "-x", "-y", "-z"] | None = None
    gravity: Vector | None = Field(None, description="[m/s^2]")
    held: list[Name] | None = Field(None, description="names; * and ? are wildcards")
    floor: Flag | Number | None = Field(
        None, description="true: a table under the lowest point; a number: at this height"
    )
    fasten_suggested: Flag | None = None
    fasten_overlaps: Flag | None = None
    loose: Flag | None = None
    density: Positive | None = Field(None, description="[kg/m^3]")
    keyframe: str | None = None
    base: Literal["fixed", "floating"] | None = None
    studs: StudsEntry | None = None
    left_out: list[Name] | None = Field(None, description="names; * and ? are wildcards")
    joined: list[Pair] | None = None
    open_pairs: list[OpenPairEntry] | None = None
    materials: list[MaterialEntry] | None = None
    friction: NotNegative | None = None
    friction_pairs: list[FrictionPairEntry] | None = None
    joints: list[JointEntry] | None = None
    bonds: list[BondEntry] | None = None
    loads: list[LoadEntry] | None = None
    straps: list[StrapEntry] | None = None
    contacts: Literal["file", "geometry"] | None = None
    tolerance: ToleranceEntry | None = None
    poses: dict[str, PoseEntry] | None = Field(None, description="new poses of parts, by name")


def build_choices_schema() -> dict[str, Any]:
    """The JSON schema of a file of choices (a user's saved options for an assembly file)."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **ChoicesFile.model_json_schema(),
    }
