"""Option names that users guess, with the real option for each."""

from __future__ import annotations

from collections.abc import Collection

__all__ = ["meant_option"]

GUESSES = {
    "--friction": ("mu", "coefficient", "friction-coefficient", "cof", "static-friction"),
    "--ground": ("held", "hold", "hold-part", "fixed", "fix", "anchor", "grounded", "support"),
    "--floor": ("table", "ground-plane", "plane"),
    "--down": ("gravity", "g", "direction", "gravity-direction"),
    "--up": ("up-axis", "vertical", "axis"),
    "--without": ("exclude", "remove", "omit", "skip", "ignore", "drop", "leave-out"),
    "--fasten": ("join", "glue", "joint", "weld", "screw", "attach", "connect"),
    "--bond": ("mortar", "magnet", "adhesive"),
    "--fasten-suggested": ("auto-fasten", "suggested", "join-suggested", "fasten-all"),
    "--fasten-overlaps": ("join-overlaps", "overlaps"),
    "--units": ("unit", "scale", "length-unit"),
    "--density": ("rho", "mass-density"),
    "--material": ("materials",),
    "--gap": ("tolerance", "tol", "eps", "epsilon", "contact-gap"),
    "--angle": ("angle-tolerance", "angular-tolerance"),
    "--clearance": ("play", "slack"),
    "--centre-within": ("center-within", "com-within", "centre"),
    "--output": ("out", "file", "save", "to"),
    "--write": ("out-file",),
    "--json": ("format", "as-json"),
    "--quiet": ("silent", "q"),
    "--verbose": ("details", "debug", "all"),
    "--effort": ("budget", "iterations", "tries"),
    "--time-limit": ("timeout", "limit", "max-time", "seconds"),
    "--require": ("level", "at-level", "requires"),
    "--proof": ("certificate", "proofs"),
    "--processes": ("jobs", "workers", "threads", "cores", "j"),
    "--sequence": ("order",),
    "--hold": ("hands", "holds"),
    "--most": ("max", "maximum", "at-most"),
}
"""Words that users type for an option."""
MEANT = {word: option for option, words in GUESSES.items() for word in words}


def meant_option(typed: str, known: Collection[str]) -> str | None:
    """The real option for a guessed option name; None if the table of guesses lacks the name.

    Parameters
    ----------
    typed : str
        The unknown option.
    known : collection of str
        Options of the command.

    Examples
    --------
    >>> meant_option("--mu", ["--up", "--friction"]), meant_option("--held", ["--ground"])
    ('--friction', '--ground')
    >>> meant_option("--mu", ["--up"]) is None
    True
    """
    option = MEANT.get(typed.lstrip("-").split("=")[0].replace("_", "-").lower())
    return option if option in known else None
