"""Results: rows of a run as a CSV file, with the environment of the run as a header."""

from __future__ import annotations

import csv
import os
import platform
from collections.abc import Iterable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from tools import Row

__all__ = ["FOLDER", "about", "read", "write"]

FOLDER = Path(__file__).resolve().parents[1] / "results"
PACKAGES = ("kilter", "numpy", "scipy", "highspy", "clarabel", "compas_cra", "mujoco")
FIELDS = tuple(Row.__dataclass_fields__)


def about() -> dict[str, str]:
    """Environment on which the figures depend, without names of hosts and without paths."""
    found = {"processor": processor(), "cores": str(os.cpu_count()), "system": platform.system()}
    found["python"] = platform.python_version()
    for name in PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


def processor() -> str:
    """Name of the processor, or its architecture."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


def write(path: Path, described: dict[str, str], rows: Iterable[Row]) -> None:
    """Write header and rows; `seconds` and `peak` have three digits."""
    with path.open("w", encoding="utf-8", newline="") as file:
        for name, value in described.items():
            file.write(f"# {name}: {value}\n")
        writer = csv.DictWriter(file, FIELDS, lineterminator="\n")
        writer.writeheader()
        for row in rows:
            data = row.to_dict()
            writer.writerow(data | {key: f"{data[key]:.3g}" for key in ("seconds", "peak")})


def read(path: Path) -> tuple[dict[str, str], list[Row]]:
    """Read the header and the rows."""
    lines = path.read_text(encoding="utf-8").splitlines()
    head = [line[2:].split(": ", 1) for line in lines if line.startswith("# ")]
    rows = []
    for data in csv.DictReader(line for line in lines if not line.startswith("# ")):
        counts = {key: int(data[key]) for key in ("bricks", "points", "runs")}
        figures = {key: float(data[key]) for key in ("seconds", "peak")}
        rows.append(Row(**{**data, **counts, **figures}))
    return dict(head), rows
