"""Masses, inertia and friction of MJCF files as kilter reads them, beside those of the engine.

    pip install -e ".[mujoco]"
    python benchmarks/mjcf_against_engine.py FOLDER...

Each MJCF file below the folders is compiled by MuJoCo, in the pose of its first keyframe. Of each
group of bodies that move together, mass, centre and inertia must agree to 1e-9. The friction of
each patch must be that of a contact of the engine between the same parts; for other pairs with a
contact of the engine, its friction must be stated. A file that kilter refuses is compared without
height fields and without the further joints of a body. The command prints each difference, and each
file that cannot be compared with the reason.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import mujoco

import kilter

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "objects"))

from engine_truth import friction_differences, mass_differences, placed, reduced

LONGEST = 60.0
"""Time limit of the contact search of a file [s]."""


def differences(model: Any) -> tuple[list[str], int]:
    """The differences of a model, and the number of compared pairs of parts."""
    data, assembly = placed(model), kilter.load(model)
    found, pairs = friction_differences(model, data, assembly, time_limit=LONGEST)
    return found + mass_differences(model, data, assembly), pairs


def compared(path: Path) -> tuple[str, list[str], int]:
    """Outcome for a file, its differences or the reason, and the number of compared pairs."""
    try:
        model = mujoco.MjModel.from_xml_path(str(path))
    except (ValueError, mujoco.FatalError) as error:
        return "not compiled", [" ".join(str(error).split())[:120]], 0
    try:
        found, pairs = differences(model)
        return ("differs" if found else "agrees"), found, pairs
    except kilter.InputError as error:
        reason = str(error)[:120]
    try:
        found, pairs = differences(reduced(path))
    except (ValueError, mujoco.FatalError, kilter.InputError) as error:
        return "refused", [reason, str(error)[:120]], 0
    return ("reduced, differs" if found else "reduced, agrees"), [reason, *found], pairs


def main() -> None:
    """Compare all files below the folders."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", nargs="+", type=Path)
    counts: Counter[str] = Counter()
    pairs = 0
    for folder in parser.parse_args().folder:
        for path in sorted(folder.rglob("*.xml")):
            if "<mujoco" not in path.read_text("utf-8", errors="replace"):
                continue
            outcome, words, touching = compared(path)
            counts[outcome] += 1
            pairs += touching
            if outcome != "agrees":
                print(f"{path.relative_to(folder)}: {outcome}: {'; '.join(words)}", flush=True)
    print(", ".join(f"{count} {outcome}" for outcome, count in sorted(counts.items())))
    print(f"touching pairs compared: {pairs}")


if __name__ == "__main__":
    main()
