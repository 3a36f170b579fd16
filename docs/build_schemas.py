"""Write the published JSON schemas from the models: python docs/build_schemas.py.

The schemas are those of the assembly file, of the file of choices, and of each answer.
"""

from __future__ import annotations

import json
from pathlib import Path

from answer_schemas import build_all_schemas

FOLDER = Path(__file__).resolve().parents[1] / "src" / "kilter" / "files" / "schemas"

if __name__ == "__main__":
    for name, content in build_all_schemas().items():
        text = json.dumps(content, indent=2, ensure_ascii=False) + "\n"
        (FOLDER / f"{name}.schema.json").write_text(text, encoding="utf-8")
