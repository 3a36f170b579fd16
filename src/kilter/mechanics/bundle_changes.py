"""Rows of proofs that follow one another: a file has only what changes from one to the next.

The states of a plan differ by a part or two, so the file would otherwise grow with the square of
their number. In such a file a list of rows is

    {"rows": [{"kept": [first, end]}, {"new": [row, ...]}, ...]}

where `kept` are rows of the same list in the proof before, each at most once and in their order.
The complete proofs are restored before any of them is judged.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from kilter.errors import InputError

ROWS = ("parts", "points", "forces")
"""Keys of a proof whose values are lists of rows."""
CHANGE_ROWS = ("without",)
"""Keys of the changes of a proof whose values are lists of rows."""
Entry = Mapping[str, Any]


def with_changes(entries: Sequence[Entry], common: Entry) -> list[dict[str, Any]]:
    """The entries of a file whose rows are changes of the rows in the entry before.

    Arguments: `entries`: each with its `change` and its whole `proof`.
    """
    written, before = [], None
    for entry in entries:
        lists = _lists(entry)
        proof = {key: rows for key, rows in entry["proof"].items() if common.get(key, ...) != rows}
        change = dict(entry["change"])
        if before is not None:
            for data, keys in ((proof, ROWS), (change, CHANGE_ROWS)):
                for key in keys:
                    if key in data and key in before:
                        data[key] = {"rows": _changes(data[key], lists[key], before[key])}
        written.append({**entry, "change": change, "proof": proof})
        before = lists
    return written


def _lists(entry: Entry) -> dict[str, list[str]]:
    """Texts of the rows of each list in an entry; two rows are the same if their texts are.

    The text of a force includes its point, since many forces are equal.
    """
    proof, change = entry["proof"], entry["change"]
    texts = {key: list(map(repr, proof[key])) for key in ROWS if key in proof}
    texts |= {key: list(map(repr, change[key])) for key in CHANGE_ROWS if key in change}
    if "forces" in texts:
        pairs = zip(texts["points"], texts["forces"], strict=True)
        texts["forces"] = [point + force for point, force in pairs]
    return texts


def _changes(rows: Sequence[Any], texts: Sequence[str], before: Sequence[str]) -> list[Any]:
    """The segments of a list of rows: those of the list before, and new rows."""
    place = {text: k for k, text in reversed(list(enumerate(before)))}
    segments: list[dict[str, Any]] = []
    end = 0
    for row, text in zip(rows, texts, strict=True):
        k = end if end < len(before) and before[end] == text else place.get(text, -1)
        if k < end:
            if not segments or "new" not in segments[-1]:
                segments.append({"new": []})
            segments[-1]["new"].append(row)
            continue
        if segments and segments[-1].get("kept", [0, -1])[1] == k:
            segments[-1]["kept"][1] = k + 1
        else:
            segments.append({"kept": [k, k + 1]})
        end = k + 1
    return segments


def restored(bundle: Any) -> Any:
    """The data of a file of several proofs with all rows of each proof.

    Data of another form are returned unchanged, and equal rows are the same objects.

    Raises `InputError` if changed rows are not those of the proof before.
    """
    entries = bundle.get("proofs") if isinstance(bundle, dict) else None
    if not isinstance(entries, list) or not isinstance(bundle.get("common"), dict):
        return bundle
    return {**bundle, "proofs": list(_restored(entries, bundle["common"]))}


def _restored(entries: Sequence[Any], common: Entry) -> Iterator[Any]:
    """The entries of a file with all rows."""
    before: Entry = {}
    for number, entry in enumerate(entries):
        if not isinstance(entry, dict) or not all(
            isinstance(entry.get(key), dict) for key in ("proof", "change")
        ):
            yield entry
            continue
        proof, change = dict(entry["proof"]), dict(entry["change"])
        for data, keys in ((proof, ROWS), (change, CHANGE_ROWS)):
            for key in keys:
                if isinstance(data.get(key), dict):
                    data[key] = _joined(data[key], before.get(key), f"proofs[{number}].{key}")
        before = {**common, **change, **proof}
        yield {**entry, "proof": proof, "change": change}


def _joined(changes: Entry, before: Any, place: str) -> list[Any]:
    """The rows of a list from the rows before it and their changes."""
    rows: list[Any] = []
    end, known = 0, before if isinstance(before, list) else []
    segments = changes.get("rows")
    if len(changes) != 1 or not isinstance(segments, list):
        raise _wrong(place)
    for segment in segments:
        kept, new = (segment.get(key) for key in ("kept", "new")) if _single(segment) else (0, 0)
        if isinstance(new, list):
            rows += new
        elif isinstance(kept, list) and list(map(type, kept)) == [int, int]:
            if not end <= kept[0] < kept[1] <= len(known):
                raise _wrong(place)
            rows += known[kept[0] : kept[1]]
            end = kept[1]
        else:
            raise _wrong(place)
    return rows


def _single(segment: Any) -> bool:
    """Whether a segment is an object with a single key."""
    return isinstance(segment, dict) and len(segment) == 1


def _wrong(place: str) -> InputError:
    return InputError(
        f"the proof cannot be read: the changes of {place} do not fit the rows before them",
        hint="make it anew with --proof",
    )
