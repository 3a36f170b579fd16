"""Count the functions of kilter that a check of two boxes enters.

    python benchmarks/entered_functions.py [--list]

Each count is of named functions, and of the files that hold them, for the Python call
``kilter.check(kilter.load(path))`` and for ``kilter check path``; ``--list`` prints their names by
file. Each is measured in a process of its own.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import subprocess
import sys
import tempfile
from collections import defaultdict
from collections.abc import Callable
from inspect import CO_OPTIMIZED
from pathlib import Path
from types import FrameType

import kilter

HOUSE = str(Path(kilter.__file__).parent)
TABLE = kilter.Part("table", kilter.Box(4, 4, 1), [0, 0, -0.5], grounded=True)
BOXES = kilter.Assembly([TABLE, kilter.Part("box", kilter.Box(1, 1, 1), [0, 0, 0.5])])


def entered(run: Callable[[], object]) -> dict[str, set[str]]:
    """Qualified names of the functions of kilter that a call enters, by file."""
    names: dict[str, set[str]] = defaultdict(set)

    def note(frame: FrameType, event: str, _: object) -> None:
        code = frame.f_code
        is_function = code.co_flags & CO_OPTIMIZED and "<" not in code.co_name
        if event == "call" and is_function and code.co_filename.startswith(HOUSE):
            names[code.co_filename[len(HOUSE) + 1 :]].add(code.co_qualname)

    sys.setprofile(note)
    try:
        run()
    finally:
        sys.setprofile(None)
    return names


def ask(way: str, path: Path) -> None:
    """Check the file by the Python call, or by the command line without its output."""
    if way == "python":
        kilter.check(kilter.load(path))
        return
    from kilter.cli import main

    with contextlib.redirect_stdout(io.StringIO()), contextlib.suppress(SystemExit):
        main(["check", str(path)])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--list", action="store_true", help="print the functions of each file")
    parser.add_argument("--of", nargs=2, metavar=("WAY", "FILE"), help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.of:
        way, path = given.of
        names = entered(lambda: ask(way, Path(path)))
        print(json.dumps({file: sorted(of_file) for file, of_file in names.items()}))
        return
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "boxes.kilter.json"
        kilter.dump(BOXES, path)
        for way in ("python", "command"):
            command = [sys.executable, __file__, "--of", way, str(path)]
            answer = subprocess.run(command, capture_output=True, text=True, check=True)
            files = json.loads(answer.stdout)
            print(f"{way}: {sum(map(len, files.values()))} functions in {len(files)} files")
            for file in sorted(files) if given.list else ():
                print(f"  {file}: {', '.join(files[file])}")


if __name__ == "__main__":
    main()
