"""Run the notebooks of the folder examples, and keep their outputs.

python docs/run_notebooks.py               run all notebooks and write their outputs
python docs/run_notebooks.py mujoco_scene  run one
python docs/run_notebooks.py --compare     write nothing; exit 1 if a printed text has changed

Needs the extras `notebook`, `figures`, `step`, `compas` and `mujoco`. Numbers of execution and
timing are removed, so that a notebook changes only if an output changes.
"""

from __future__ import annotations

import base64
import io
import json
import re
import sys
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).resolve().parents[1] / "examples"
TIME = 300
"""Longest time of a cell [s]."""
WIDTH = 560
"""Width of a picture that is kept [pixels]."""
COLOURS = 48
"""Number of colours of a picture that is kept."""


def executed(path: Path) -> Any:
    """A notebook with the outputs of a new run in its folder."""
    import nbformat
    from nbclient import NotebookClient

    notebook = nbformat.read(path, as_version=4)
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell.outputs = []
    client = NotebookClient(notebook, timeout=TIME, resources={"metadata": {"path": path.parent}})
    client.execute()
    for cell in notebook.cells:
        cell.metadata.clear()
        if cell.cell_type == "code":
            cell.execution_count = None
            for output in cell.outputs:
                if "execution_count" in output:
                    output.execution_count = None
                output.get("metadata", {}).clear()
                if "image/png" in output.get("data", {}):
                    output.data["image/png"] = small_picture(output.data["image/png"])
    notebook.metadata.language_info = {"name": "python"}
    return notebook


def small_picture(png: str) -> str:
    """A picture (base64) with fewer pixels and colours, so that the repository stays small."""
    from PIL import Image

    image = Image.open(io.BytesIO(base64.b64decode(png))).convert("RGB")
    height = round(image.height * WIDTH / image.width)
    image = image.resize((WIDTH, height), Image.Resampling.LANCZOS).quantize(COLOURS)
    stream = io.BytesIO()
    image.save(stream, "PNG", optimize=True)
    return base64.b64encode(stream.getvalue()).decode()


def texts(notebook: Any) -> list[str]:
    """The printed text of each cell of code; pictures differ between versions of matplotlib."""
    return [
        "".join(output.get("text", "") for output in cell.outputs)
        for cell in notebook.cells
        if cell.cell_type == "code"
    ]


def extras(path: Path) -> str:
    """Extras that a notebook names in its installation command, with commas."""
    text = "".join(json.loads(path.read_text(encoding="utf-8"))["cells"][0]["source"])
    found = re.search(r'pip install "kilter\[([a-z,]+)\]"', text)
    if not found:
        raise ValueError(f"{path.name}: its first cell names no installation command")
    return found[1]


def main() -> int:
    """Run the named notebooks, or all; return the exit code."""
    import nbformat

    names = [word for word in sys.argv[1:] if word != "--compare"]
    changed = 0
    for path in sorted(FOLDER.glob("*.ipynb")):
        if names and path.stem not in names:
            continue
        new = executed(path)
        if "--compare" not in sys.argv:
            nbformat.write(new, path)
        elif texts(new) != texts(nbformat.read(path, as_version=4)):
            sys.stderr.write(f"{path.name}: its printed text has changed\n")
            changed = 1
    return changed


if __name__ == "__main__":
    sys.exit(main())
