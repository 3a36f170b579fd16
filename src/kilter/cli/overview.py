"""Names of the commands in groups, and the help text of the program.

The module imports nothing, so that `kilter --help` needs neither the parser of options nor the
modules of the commands.
"""

from __future__ import annotations

GROUPS: dict[str, dict[str, str]] = {
    "ask": {
        "check": "does it stay together, and which parts move if not?",
        "contacts": "which parts touch, and which nearly touch?",
        "scene": "which objects of a scene are at rest, float, overlap or fall?",
        "why": "why do the bodies of a state of MuJoCo move, by its contacts?",
        "orient": "in which orientation does it stay with the widest margin?",
        "region": "in which directions of gravity does it stay?",
        "margin": "how far may it tilt, and which change helps most?",
        "transport": "how hard may it be accelerated?",
    },
    "plan": {
        "plan": "in which order can it be put together?",
        "hold": "which supports are the fewest that hold it?",
        "place": "where does the next part stand?",
        "check-plan": "does each item of a packing plan stand?",
        "settle": "where do parts come to rest that overlap or hang?",
    },
    "show": {
        "report": "write an offline page in 3D with all answers",
        "view": "open the workbench in the browser",
        "draw": "write a figure or a film",
    },
    "files": {
        "save": "save the options about a file for all later commands",
        "verify": "recompute a proof without any solver",
        "batch": "check many files, and write a table",
        "example": "list the built-in examples, or write one of them",
        "mcp": "serve these questions as tools for agents",
        "help": "print a page of the documentation: kilter help cad",
        "doctor": "test this installation (kilter --version: its version)",
    },
}
"""Names of the commands by group, each with its summary in a few words."""
PURPOSE = "Does an assembly of rigid parts stay together? Options: kilter COMMAND --help"


def overview() -> str:
    """Help text of the program: its purpose, the way to its options, its commands in groups."""
    lines = [PURPOSE]
    for group, entries in GROUPS.items():
        for k, (name, summary) in enumerate(entries.items()):
            lines.append(f"{'' if k else group:7}{name:11}{summary}")
    return "\n".join(lines) + "\n"
