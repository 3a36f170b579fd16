"""The command `improve`: a brick to add to a model or to remove from it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from kilter.cli.asked import Asked
from kilter.cli.exit_codes import IMPROVE
from kilter.cli.options import FORM, asks
from kilter.cli.output import Progress
from kilter.values.declaration import option

__all__ = ["improve"]


@dataclass(frozen=True, kw_only=True)
class ImproveOptions:
    """Options of `improve`."""

    write: Path | None = option(
        "--write CHANGED.json", "Also write the model with the best change, as a kilter file.", FORM
    )


@asks(searches=True)
def improve(asked: Asked, options: ImproveOptions) -> int:
    """Find a brick to add or to remove so that a brick model stands, or needs weaker studs.

    The tried places follow from the fall, or from the first motion beyond the strength of the
    studs. For every change the needed strength is computed again.

    Exit code: 0 it stands, as it is or with the named change; 1 no tried single change is enough.
    """
    from kilter.analysis.margins.improve import improve as find
    from kilter.files.writing import dump

    asked.apart(options.write)
    with Progress(asked.quiet) as progress:
        assembly, _ = asked.read(progress)
        improvement = find(assembly, **asked.shared(find, None, progress))
    after = ""
    if options.write is not None and improvement.best is not None:
        dump(improvement.best.assembly, options.write)
        after = f"\nchanged model  written to {options.write}"
    elif options.write is not None:
        after = "\nchanged model  not written: no change lowers the strength that the model needs"
    asked.tell(improvement.to_dict(), after=after)
    return IMPROVE[improvement.stands]
