"""Run OCCT in a separate process, which starts early and is kept.

A damaged file may crash OCCT, or let it run without end. The file is then read again. If OCCT was
working on a solid, a stand-in replaces that solid; otherwise a second failure rejects the file.
"""

from __future__ import annotations

import atexit
from collections.abc import Callable, Collection
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kilter.errors import InputError
from kilter.files.reader_guard import Answer, ReaderProcess, Request, bound_memory, serve_requests
from kilter.pipes import can_start

if TYPE_CHECKING:
    from kilter.files.meshes.placed import FileBodies


MEMORY = 16 << 30
"""Largest address space of the process [bytes]; a damaged file may demand more."""
BREAKDOWNS = 50
"""Number of solids of a file that may crash OCCT before the file is rejected."""


STALLS = 12.0
"""CPU time allowed for a solid, or for reading the file, independently of its size [s]."""
STALLS_PER_MEGABYTE = 12.0
"""CPU time allowed in addition for each megabyte [s/MB]; valid files need at most a fifth."""


_NAMES = {".fcstd": "FreeCAD document", ".igs": "IGES", ".iges": "IGES"}
"""Names of the formats other than STEP."""
_kept: list[ReaderProcess] = []


def begin_early(ahead: Path | None = None) -> None:
    """Start the child process early, and let it read the file `ahead` in advance."""
    if not _kept and can_start():
        _kept.append(ReaderProcess(__name__))
        atexit.register(_end)
        if ahead is not None:
            _kept[0].ask_ahead(_request(ahead, (), set()))


def _request(path: Path, without: tuple[str, ...], broken: set[int]) -> Request:
    """Request to the child process: read a file, except the solids `without` and `broken`.

    It contains the time of change and the size of the file, since another state is another request.
    """
    state = path.stat()
    most = STALLS + STALLS_PER_MEGABYTE * state.st_size / 2**20
    changed = (state.st_mtime_ns, state.st_size)
    return most, (str(path.absolute()), changed, without, broken)


def _end() -> None:
    """End the child process if it runs."""
    while _kept:
        _kept.pop().end()


def format_of(path: Path) -> str:
    """Name of the format of a file that OCCT reads."""
    return _NAMES.get(path.suffix.lower(), "STEP")


def read_apart(path: Path, without: tuple[str, ...], progress: Callable[[str], None]) -> FileBodies:
    """Read the solids of a file in a child process, which a crash of OCCT may end.

    Raises `InputError` if the file is damaged.
    """
    if not can_start():
        return _read_here(path, without, lambda stage, solid: progress(stage))
    from kilter.arrays import sealed

    broken: set[int] = set()
    at_work, again = -1, False

    def tell(stage: str, solid: int) -> None:
        nonlocal at_work
        at_work = solid
        progress(stage)

    while True:
        request = _request(path, without, broken)
        if _kept and _kept[0].ahead not in (None, request):
            _end()  # the process is reading another file ahead
        begin_early()
        try:
            bodies: FileBodies = _kept[0].ask(request, tell)
        except EOFError:
            _end()
            if (at_work < 0 and again) or at_work in broken or len(broken) >= BREAKDOWNS:
                raise InputError(
                    f"damaged {format_of(path)}: OCCT crashes on it, or does not finish",
                    hint="export it again",
                ) from None
            if at_work >= 0:
                broken.add(at_work)
            at_work, again = -1, at_work < 0
        except InputError:
            raise
        except BaseException:  # after an interrupt the next answer would be that of this request
            _end()
            raise
        else:
            return sealed(bodies)


def _read_here(
    path: Path,
    without: tuple[str, ...],
    tell: Callable[[str, int], None],
    broken: Collection[int] = (),
) -> FileBodies:
    """Read the solids of a file in this process."""
    if path.suffix.lower() == ".fcstd":
        from kilter.files.cad.freecad_bodies import freecad_bodies

        return freecad_bodies(path, without, tell, broken)
    from kilter.files.cad.step_document import step_bodies

    return step_bodies(path, without, tell, broken)


def serve() -> None:
    """Main function of the child process."""
    serve_requests(_load)


def _load() -> Answer:
    """Load OCCT, before the first request, and return the reader."""
    bound_memory(MEMORY)
    import OCP.STEPCAFControl  # noqa: F401

    import kilter.files.cad.step_document  # noqa: F401

    def read(
        tell: Callable[..., None],
        path: str,
        _: tuple[int, int],
        without: tuple[str, ...],
        broken: set[int],
    ) -> Any:
        return _read_here(Path(path), without, tell, broken)

    return read
