"""Fixtures that write small files for the tests of the readers."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kilter.shape.primitives import Box, surface

CUBE = {"name": "C1", "box": [1, 1, 1]}


@pytest.fixture
def write(tmp_path: Path) -> Callable[[str, Any], Path]:
    """Writes a file from bytes, text or a JSON value, and returns its path."""

    def written(name: str, content: Any) -> Path:
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if isinstance(content, bytes):
            path.write_bytes(content)
        elif isinstance(content, str):
            path.write_text(content, encoding="utf-8")
        else:
            path.write_text(json.dumps(content), encoding="utf-8")
        return path

    return written


@pytest.fixture
def obj_box() -> Callable[..., str]:
    """Lines of a box of quads in OBJ; `first`: number of its first vertex."""

    def lines(size: float = 1.0, at: tuple[float, float, float] = (0, 0, 0), first: int = 1) -> str:
        vertices, _ = surface(Box([size] * 3))
        quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
        rows = [f"v {x!r} {y!r} {z!r}" for x, y, z in (vertices + np.array(at)).tolist()]
        faces = ["f " + " ".join(str(k + first) for k in quad) for quad in quads]
        return "\n".join([*rows, *faces]) + "\n"

    return lines
