"""`kilter.view`: open the workbench in the browser."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from kilter.assembly import Assembly
from kilter.errors import InputError
from kilter.files.writing import dump
from kilter.values.guesses import guarded

__all__ = ["view"]


@guarded
def view(
    source: Assembly | str | Path | None = None,
    *,
    port: int = 0,
    browser: bool = True,
    hosts: Sequence[str] = (),
    folder: str | Path | None = None,
    keys: dict[str, Any] | None = None,
    down: Sequence[float] | None = None,
    say: Callable[[str], None] | None = None,
) -> None:
    """Open the workbench: the page on which an assembly is held, joined, loaded and judged.

    The page is served to this machine only. The function returns after an interruption (Ctrl-C).
    Only files of the opened folder can be opened, and named by these files.

    Parameters
    ----------
    source : Assembly or path, optional
        Assembly, or a file; without it, the page begins with a list of files and examples.
    port : int
        Port of the server; 0 selects a free port.
    browser : bool
        Open the page in a browser.
    hosts : sequence of str
        Further host names under which a proxy serves the page; pages of these names are trusted.
        "0.0.0.0" or "::" also listens on all addresses of this machine, for a container.
    folder : path, optional
        The opened folder; that of `source` by default.
    keys : dict, optional
        First choices about the file, as JSON data.
    down : sequence of 3 float, optional
        Direction of gravity in these choices.
    say : callable, optional
        Function that is called with each line for the user; the first is the address.

    Raises
    ------
    InputError
        If the port is not available, the file or the folder does not exist, the file is a link that
        leads out of the opened folder, a host name is invalid, or the function is called in a cell
        of a notebook, which it would block.

    See Also
    --------
    kilter.report : a page as a file, without a server.
    kilter.draw : a picture as a file.
    """
    if in_notebook():
        raise InputError(
            "view serves a page until it is interrupted, so it would block the cell",
            hint="use assembly.show() in a notebook, or 'kilter view FILE' in a terminal",
        )
    # imported late: the server libraries take longer to import than kilter
    from kilter.workbench.server import Workbench, folder_of

    tell = say or (lambda line: None)
    opened = None if folder is None else Path(folder)
    if opened is not None and not opened.is_dir():
        raise InputError("no such folder", file=str(opened), hint="check the path")
    with tempfile.TemporaryDirectory(prefix="kilter-") as temporary:
        path = _path_of(source, Path(temporary))
        if path is not None:
            _require_inside(path, opened or folder_of(path))
        first = {"keys": keys, "down": down}
        bench = Workbench(path, first=first, folder=opened, port=port, hosts=hosts, say=tell)

        def ready() -> None:
            tell(bench.url)
            if browser:
                import webbrowser

                webbrowser.open(bench.url)

        bench.run(ready)


def in_notebook() -> bool:
    """Whether this code runs in a cell of a notebook: IPython runs, and with a kernel."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return hasattr(shell, "kernel")


def _require_inside(path: Path, folder: Path) -> None:
    """Raise `InputError` if a file is not below the opened folder, after links are followed."""
    place = Path(os.path.realpath(path))
    if not place.is_relative_to(os.path.realpath(folder)):
        raise InputError(
            f"leads out of the opened folder, to {str(place)!r}",
            file=str(path),
            hint="open the file there, or give the folder above both with --folder",
        )


def _path_of(source: Any, folder: Path) -> Path | None:
    """Path of the file to open; an assembly is written to a temporary folder first."""
    if source is None:
        return None
    if isinstance(source, Assembly):
        path = folder / f"{Path(source.source or 'assembly').stem or 'assembly'}.kilter.json"
        dump(source, path)
        return path
    path = Path(os.fspath(source))
    if not path.exists():
        raise InputError("no such file", file=str(path), hint="check the path")
    return path
