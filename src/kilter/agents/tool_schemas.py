"""Tools for agents: the name, description and JSON schema of each.

The schemas are short, since an agent reads all of them before its first call. The options of
reading a file are the same for all tools and have the names of the command line.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from kilter.tell.levels import LEVELS

NUMBER: dict[str, Any] = {"type": "number"}
NAMES: dict[str, Any] = {"type": "array", "items": {"type": "string"}}
VECTOR: dict[str, Any] = {"type": "array", "items": NUMBER, "minItems": 3, "maxItems": 3}
POINT: dict[str, Any] = {"type": "array", "items": NUMBER, "minItems": 2, "maxItems": 2}

READING: dict[str, dict[str, Any]] = {
    "file": {"type": "string", "description": "path below the start folder"},
    "ground": {**NAMES, "description": "parts to hold; * and ? are wildcards"},
    "floor": {"type": ["boolean", "number"], "description": "true: table under all; or its height"},
    "without": {**NAMES, "description": "parts to leave out"},
    "friction": {**NUMBER, "description": "coefficient"},
    "down": {**VECTOR, "description": "direction of gravity"},
    "up": {"type": "string", "description": "up axis: x, y, z, -x, -y, -z"},
    "units": {"type": "string", "description": "m, cm, mm or in, if the file states none"},
    "fasten": {
        "type": "array",
        "items": {**NAMES, "minItems": 2, "maxItems": 2},
        "description": "pairs of parts to join rigidly",
    },
}
"""Options of reading a file, of all tools with a file."""
REQUIRE = {"type": "string", "enum": list(LEVELS[:-1]), "description": "level that counts as yes"}
OUTPUT = {"type": "string", "description": "new file: X.kilter.json, X.xml, or X.usda for USD"}


@dataclass(frozen=True, slots=True)
class Tool:
    """A tool for agents."""

    name: str
    description: str
    options: dict[str, dict[str, Any]]
    """JSON schema of each argument besides those of reading a file."""
    reads: bool = True
    """Whether the tool has a file as its argument."""

    @property
    def arguments(self) -> dict[str, dict[str, Any]]:
        """JSON schema of each argument."""
        return {**READING, **self.options} if self.reads else self.options

    @property
    def schema(self) -> dict[str, Any]:
        """JSON schema of the arguments."""
        return {
            "type": "object",
            "properties": self.arguments,
            "required": required_of(self),
            "additionalProperties": False,
        }


def required_of(tool: Tool) -> list[str]:
    """Names of the arguments that a call must have."""
    return ["file"] if tool.reads else []


TOOLS: tuple[Tool, ...] = (
    Tool("check", "Does it stay together under gravity, and which parts move if not? With a proof, "
         "and with the changes that were tried.", {"require": REQUIRE}),
    Tool("contacts", "Which parts touch, nearly touch or overlap?", {}),
    Tool("margin", "How far may it tilt, how little friction does it need, and what helps?", {}),
    Tool("hold", "The fewest supports that hold what falls.",
         {"require": REQUIRE, "most": {"type": "integer", "description": "largest number"}}),
    Tool("plan", "An order of assembly, with the parts to hold at each step.", {}),
    Tool("settle", "Bring parts that overlap or hang to rest: they fall, tip, slide and roll until "
         "they rest or leave the scene.", {
        "require": REQUIRE,
        "reach": {**NUMBER, "description": "largest way of a part [file units]"},
        "nearest": {"type": "boolean", "description": "the least motion: parts do not fall"},
        "keep": {**NAMES, "description": "parts that must not move"},
        "output": OUTPUT,
    }),
    Tool("place", "Where does the next box stand, and how heavy may it be there?", {
        "box": {**VECTOR, "description": "length, width, height [file units]"},
        "mass": {**NUMBER, "description": "[kg]"},
        "at": {**POINT, "description": "x and y of its centre; without it, all places"},
        "turn": {**NUMBER, "description": "angle about the vertical [deg]"},
    }),
    Tool("transport", "How hard may its carrier accelerate, brake and turn?",
         {"accelerate": {**VECTOR, "description": "is this acceleration carried? [m/s^2]"}}),
    Tool("scene", "The state of each object of a scene: at rest, floats, overlaps, falls. Clusters "
         "are judged separately.", {
        "require": REQUIRE,
        "settle": {"type": "boolean", "description": "bring the objects to rest first"},
        "output": {**OUTPUT, "description": "with settle: write the settled scene here"},
    }),
    Tool("draw", "A picture of the assembly with its motion or forces.", {
        "what": {"type": "string", "enum": ["assembly", "region"]},
        "view": {**POINT, "description": "azimuth and elevation of the eye [deg]"},
    }),
    Tool("example", "List the built-in examples, or write an example into the start folder.",
         {"name": {"type": "string"}}, reads=False),
)  # fmt: skip
"""All tools, in the order in which an agent sees them."""


def tool_named(name: str) -> Tool | None:
    """The tool with a name; None if there is none."""
    return next((tool for tool in TOOLS if tool.name == name), None)
