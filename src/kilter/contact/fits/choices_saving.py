"""Save reading options as a file of choices."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from kilter.contact.common.gaps import Tolerance
from kilter.contact.fits.chosen import chosen, tolerance_of
from kilter.contact.fits.fastening import fasten_as_read
from kilter.errors import InputError
from kilter.files.choices import Choices, find_choices
from kilter.files.choices_writing import choices_about, require_place, write_choices
from kilter.files.reading import Reading, reading_for
from kilter.values.guesses import guarded

__all__ = ["save", "save_reading"]


@guarded
def save(
    source: str | Path,
    output: str | Path,
    *,
    fasten: Iterable[Sequence[str]] = (),
    fasten_suggested: bool = False,
    fasten_overlaps: bool = False,
    bond: Iterable[tuple[str, str, float]] = (),
    materials: Iterable[Mapping[str, Any]] = (),
    open_pairs: Iterable[Mapping[str, Any]] = (),
    tolerance: Mapping[str, float | None] | None = None,
    loose: bool = False,
    **reading: Any,
) -> Choices:
    """Save the options with which a file is read, as ``kilter save`` does.

    The file is read with the options, so that a wrong name is an error here. If `source` has
    choices itself, the new choices are its choices with the given changes.

    Parameters
    ----------
    source : path
        A file or a folder that `kilter.load` reads.
    output : path
        File of the choices, which ends in .json, in the folder of `source` or above it.
    fasten : iterable of pairs of str
        Parts that are joined rigidly where they touch; ``*`` and ``?`` are wildcards.
    fasten_suggested, fasten_overlaps : bool
        Join the pairs that look fastened, or that overlap.
    bond : iterable of (str, str, float)
        Two parts and the pull that each contact point between them resists [N].
    materials, open_pairs, tolerance, loose
        See `kilter.Choices`.
    **reading
        Options of `kilter.load`: `ground`, `floor`, `friction` and so on.

    Returns
    -------
    Choices

    Raises
    ------
    InputError
        If the file cannot be read with the options, or the choices cannot be written.

    See Also
    --------
    kilter.dump : writes an assembly.
    kilter.load : reads a file with its saved options.
    """
    if not isinstance(source, str | Path):
        raise InputError(
            f"save keeps the options of reading a file, and got {type(source).__name__}",
            hint="write an assembly: kilter.dump(assembly, path)",
        )
    entries = {"materials": list(materials), "open_pairs": list(open_pairs)}
    read = reading_for(
        **reading,
        fasten=tuple((a, b) for a, b in fasten),
        fasten_suggested=fasten_suggested,
        fasten_overlaps=fasten_overlaps,
        bond=tuple((a, b, float(pull)) for a, b, pull in bond),
        entries={key: value for key, value in entries.items() if value},
    )
    path, earlier = Path(source), find_choices(source)
    keys: dict[str, Any] = {"tolerance": dict(tolerance or {}), "loose": loose}
    if earlier is not None:
        both = chosen(earlier, read)
        path, read = both.path, both.reading
        keys["tolerance"] = {**(both.choices.tolerance or {}), **keys["tolerance"]}
        keys["loose"] = loose or both.choices.loose
    return save_reading(path, output, read, keys)


def save_reading(
    path: Path,
    output: str | Path,
    reading: Reading,
    keys: Mapping[str, Any],
    *,
    progress: Callable[[str], None] | None = None,
) -> Choices:
    """Read a file with given options as a trial, then save these options as choices.

    Parameters
    ----------
    path : Path
        The file.
    output : path
        File of the choices.
    reading : Reading
    keys : mapping
        Keys of the tolerance: `tolerance` and `loose`.
    progress : callable, optional
        Called with the name of each stage.

    Raises
    ------
    InputError
        If the file cannot be read with the options, or the choices cannot be written.
    """
    output = Path(output)
    require_place(output)
    if not path.exists():
        raise InputError("no such file", file=str(path), hint="check the path")
    assembly = reading.read(path, progress=progress)
    bodies = assembly.names if reading.floor is None else assembly.names[:-1]
    reading = reading.released(bodies)
    choices = choices_about(path, output.parent, reading.options(), **keys)
    tolerance: Tolerance = tolerance_of(choices)
    fasten_as_read(assembly, reading, tolerance=tolerance, progress=progress)
    if reading.down is not None:
        gravity = assembly.gravity.tolist()
        options = reading.options()
        choices = choices_about(path, output.parent, options, **keys, up=None, gravity=gravity)
    write_choices(choices, output)
    return choices
