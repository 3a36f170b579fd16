"""Reproducibility: answers must be equal, bit for bit, under different conditions.

    python benchmarks/same_answer.py            the scenes and 30 random assemblies
    python benchmarks/same_answer.py FOLDER     also the assemblies in the subfolders of a folder

Each assembly is checked in a separate process under four conditions: alone with a single thread,
next to four busy processes, with another PYTHONHASHSEED, and with two threads. All numbers of the
answers except `seconds` are compared. The exit code is 1 if an answer differs.
"""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "scenes"))

RANDOM = 30
"""Number of random assemblies."""
LIMIT = 300
"""Time limit for an assembly [s]."""
CONDITIONS = {
    "alone": {"PYTHONHASHSEED": "0", "threads": "1", "busy": "0"},
    "busy": {"PYTHONHASHSEED": "0", "threads": "1", "busy": "4"},
    "hash seed 1": {"PYTHONHASHSEED": "1", "threads": "1", "busy": "0"},
    "two threads": {"PYTHONHASHSEED": "0", "threads": "2", "busy": "0"},
}
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS")


def subjects(folders: list[Path], into: Path) -> list[tuple[str, list[str]]]:
    """Names of the assemblies, and the arguments of ``kilter check`` for each."""
    from random_friction import random_assembly

    from kilter import dump
    from kilter.scenes import SCENES, scene

    found = []
    for name in SCENES:
        file = into / f"{name}.kilter.json"
        dump(scene(name), file)
        found.append((name, [str(file)]))
    for seed in range(RANDOM):
        file = into / f"random-{seed}.kilter.json"
        dump(random_assembly(seed)[1], file)
        found.append((file.stem, [str(file)]))
    for folder in folders:
        for one in sorted(path for path in folder.glob("*/*") if path.suffix in ("", ".json")):
            if one.name == "LICENSE":
                continue
            found.append((str(one), [str(one), "--floor", "--friction", "0.6"]))
    return found


def answered(words: list[str], condition: dict[str, str]) -> str:
    """Verdict and digest of the answer without times; else the exit code, or "late"."""
    known = dict.fromkeys(THREADS, condition["threads"])
    environment = os.environ | known | {"PYTHONHASHSEED": condition["PYTHONHASHSEED"]}
    spin = [sys.executable, "-c", "while True: pass"]
    others = [subprocess.Popen(spin) for _ in range(int(condition["busy"]))]
    command = [sys.executable, "-m", "kilter", "check", *words, "--json", "--quiet"]
    try:
        ran = subprocess.run(
            command, env=environment, capture_output=True, text=True, timeout=LIMIT, check=False
        )
    except subprocess.TimeoutExpired:
        return "late"
    finally:
        for one in others:
            one.kill()
    if not ran.stdout:
        return f"exit {ran.returncode}"
    answer = json.loads(ran.stdout)
    answer.pop("seconds")
    text = json.dumps(answer, sort_keys=True)
    return f"{answer['verdict']} {hashlib.sha256(text.encode()).hexdigest()[:12]}"


def main() -> int:
    """Compare all assemblies; return 1 if an answer differs."""
    different = late = 0
    with tempfile.TemporaryDirectory() as folder:
        asked = subjects([Path(word) for word in sys.argv[1:]], Path(folder))
        for name, words in asked:
            answers = {key: answered(words, one) for key, one in CONDITIONS.items()}
            same = len(set(answers.values())) == 1
            different += not same
            late += "late" in answers.values()
            print(f"{name:<40} {answers['alone'] if same else answers}", flush=True)
    print(f"{len(asked)} assemblies, {different} that differ, {late} over the time limit")
    return int(bool(different))


if __name__ == "__main__":
    sys.exit(main())
