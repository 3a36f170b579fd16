"""Run the notebooks of the folder examples, and keep their outputs.

python docs/run_notebooks.py            run all notebooks and write their outputs
python docs/run_notebooks.py architect  run one

Needs the extras `notebook`, `figures` and `step`. Numbers of execution and timing are removed, so
that a notebook changes only if an output changes.
"""

from __future__ import annotations

import base64
import io
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


def main() -> None:
    """Run the named notebooks, or all."""
    import nbformat

    for path in sorted(FOLDER.glob("*.ipynb")):
        if sys.argv[1:] and path.stem not in sys.argv[1:]:
            continue
        nbformat.write(executed(path), path)


if __name__ == "__main__":
    main()
