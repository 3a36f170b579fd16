"""Damage to files: to bytes, words, the tree of a JSON, the members of a zip."""

import io
import json
import re
import zipfile
from collections.abc import Callable
from typing import Any

import numpy as np
from fuzz_corpus import numbers

Random = np.random.Generator
ODD = ("", "table", "\0", "\x1b[31m", "../../etc", "ü\u202e", "b\ud800")
"""Texts as values of a JSON."""
TEXTS = ("step", "stl", "obj", "urdf", "xml", "usda", "csv", "txt", "mpd")
"""Endings of texts of words and numbers."""
TABLES = ("csv", "txt", "mpd")
"""Endings of texts whose lines have a meaning of their own."""
NUMBER = re.compile(rb"-?\d+(?:\.\d*)?(?:[eE][+-]?\d{1,3})?")


def damaged(name: str, content: bytes, rng: Random) -> bytes:
    """The content with one to four mutations that suit its format; half of all keep its form."""
    ways = [flipped, cut, doubled, swapped, renumbered, *[nudged] * 4]
    if name.endswith("json"):
        ways += [*[reshaped] * 4, enlarged]
    if name.endswith(("3mf", "FCStd")):
        ways += [rezipped] * 6
    if name.endswith("glb"):
        ways += [rechunked] * 6
    if name.endswith(TEXTS):
        ways += [*[renumbered, reworded] * 2, enlarged]
    if name.endswith(TABLES):
        ways += [relined] * 2
    if rng.random() < 0.4:
        ways = [nudged]
    for _ in range(int(rng.choice([1, 1, 2, 3, 4]))):
        content = ways[int(rng.integers(len(ways)))](content, rng)
    return content


def flipped(content: bytes, rng: Random) -> bytes:
    """Some bytes replaced."""
    data = bytearray(content)
    for k in rng.integers(0, max(len(data), 1), int(rng.integers(1, 9))):
        if data:
            data[int(k)] = int(rng.integers(256))
    return bytes(data)


def cut(content: bytes, rng: Random) -> bytes:
    """A stretch taken out; often all that follows."""
    start = int(rng.integers(0, len(content) + 1))
    end = len(content) if rng.random() < 0.5 else start + int(rng.integers(1, 200))
    return content[:start] + content[end:]


def doubled(content: bytes, rng: Random) -> bytes:
    """A stretch written twice."""
    start = int(rng.integers(0, len(content) + 1))
    stretch = content[start : start + int(rng.integers(1, 400))]
    return content[:start] + stretch + content[start:]


def swapped(content: bytes, rng: Random) -> bytes:
    """Two lines exchanged."""
    lines = content.split(b"\n")
    if len(lines) > 2:
        a, b = (int(k) for k in rng.integers(0, len(lines), 2))
        lines[a], lines[b] = lines[b], lines[a]
    return b"\n".join(lines)


def renumbered(content: bytes, rng: Random) -> bytes:
    """A number replaced by another, where the content is text."""
    found = list(NUMBER.finditer(content))
    if not found or b"\0" in content[:200]:
        return flipped(content, rng)
    for match in reversed([found[int(k)] for k in np.unique(rng.integers(0, len(found), 2))]):
        content = content[: match.start()] + numbers(rng).encode() + content[match.end() :]
    return content


def nudged(content: bytes, rng: Random) -> bytes:
    """A number of a text a little larger or smaller, of the other sign, or another one of it."""
    found = [] if b"\0" in content[:200] else list(NUMBER.finditer(content))
    if not found:
        return _nudged_singles(content, rng)
    match, other = (found[int(k)] for k in rng.integers(0, len(found), 2))
    word = other[0]
    if rng.random() < 0.6:
        word = _near(float(match[0]), rng).encode()
    return content[: match.start()] + word + content[match.end() :]


def _near(value: float, rng: Random) -> str:
    size = 10.0 ** rng.uniform(-16, 0) * rng.choice([-1, 1])
    value = min(max(value, -1e300), 1e300)
    near = [
        value * (1 + size),
        value + size,
        -value,
        value * 10.0 ** rng.integers(-3, 4),
        value + 1,
    ]
    found = float(near[int(rng.integers(len(near)))])
    return str(int(found)) if value.is_integer() and rng.random() < 0.5 else repr(found)


def _nudged_singles(content: bytes, rng: Random) -> bytes:
    """A float32 in the second half of a binary file a little other: there are its coordinates."""
    if len(content) < 100:
        return content
    at = 4 * int(rng.integers(len(content) // 8, len(content) // 4 - 1)) + int(rng.choice([0, 2]))
    value = np.frombuffer(content, "<f4", 1, at)
    with np.errstate(all="ignore"):
        near = (value * np.float32(1 + 10.0 ** rng.uniform(-7, 0))).tobytes()
    return content[:at] + near + content[at + 4 :]


def reworded(content: bytes, rng: Random) -> bytes:
    """A word of a text replaced by another of it, or by an odd one."""
    found = list(re.finditer(rb"[A-Za-z_.#\d-]+", content))
    if not found or b"\0" in content[:200]:
        return flipped(content, rng)
    match, other = (found[int(k)] for k in rng.integers(0, len(found), 2))
    odd = [
        b"",
        b"\0",
        b"\x1b[2J",
        b"a" * 3000,
        "\u202eü".encode(),
        b"../../x.stl",
        b"/dev/zero",
        b"&a;",
    ]
    word = other[0] if rng.random() < 0.6 else odd[int(rng.integers(len(odd)))]
    return content[: match.start()] + word + content[match.end() :]


def enlarged(content: bytes, rng: Random) -> bytes:
    """A word or number of a text that is very long, or deep brackets in its place."""
    found = list(re.finditer(rb"[A-Za-z_.#\d-]+", content))
    if not found or b"\0" in content[:200]:
        return flipped(content, rng)
    match = found[int(rng.integers(len(found)))]
    size = int(rng.choice([300, 4000, 70_000, 140_000]))
    large = [b"a" * size, b"9" * size, b"1" + b"0" * 309, b"[" * size, b'{"a":' * size]
    word = large[int(rng.integers(len(large)))]
    return content[: match.start()] + word + content[match.end() :]


def relined(content: bytes, rng: Random) -> bytes:
    """Lines with other ends, a few of them only, many times over, or in another encoding."""
    lines = content.split(b"\n")
    k = int(rng.integers(len(lines)))
    ways: list[Callable[[], bytes]] = [
        lambda: b"\r".join(lines),
        lambda: content.replace(b"\n", b"\r\n"),
        lambda: b"\n".join([*lines[:k], lines[k].replace(b",", b"\r,", 1), *lines[k + 1 :]]),
        lambda: b"\n".join(lines[: k + 1]),
        lambda: b"\n".join([*lines[:k], *[lines[k]] * int(rng.integers(2, 300)), *lines[k + 1 :]]),
        lambda: b"\xef\xbb\xbf" + content,
        lambda: content.decode("latin-1").encode("utf-16"),
        lambda: content.replace(b",", b'"', 1),
        lambda: content.replace(lines[k][:1], b"\xed\xa0\x80", 1),
        lambda: content.replace(lines[k][:1], b"\0", 1),
    ]
    return ways[int(rng.integers(len(ways)))]()


def rechunked(content: bytes, rng: Random) -> bytes:
    """A GLB whose header is damaged as a JSON, its lengths put right."""
    size = int.from_bytes(content[12:16], "little")
    if content[:4] != b"glTF" or 20 + size > len(content):
        return flipped(content, rng)
    header = reshaped(content[20 : 20 + size], rng)
    header += b" " * (-len(header) % 4)
    rest = content[20 + size :]
    length = 20 + len(header) + len(rest)
    return (
        content[:8]
        + length.to_bytes(4, "little")
        + len(header).to_bytes(4, "little")
        + b"JSON"
        + header
        + rest
    )


def reshaped(content: bytes, rng: Random) -> bytes:
    """A value of a JSON tree replaced, dropped, repeated or nested."""
    try:
        tree = json.loads(content)
    except (ValueError, RecursionError):
        return flipped(content, rng)
    places = _places(tree)
    if not places:
        return content
    holder, key = places[int(rng.integers(len(places)))]
    change = int(rng.integers(4))
    if change == 0:
        del holder[key]
    elif change == 1 and isinstance(holder, list):
        holder.insert(key, holder[key])
    else:
        holder[key] = _other(holder[key], rng)
    try:
        return json.dumps(tree).encode("utf-8", "surrogatepass")
    except (ValueError, RecursionError):
        return content


def _places(tree: Any) -> list[tuple[Any, Any]]:
    """Every (container, key) of a JSON tree."""
    found, waiting = [], [tree]
    while waiting:
        node = waiting.pop()
        keys = list(node) if isinstance(node, dict) else range(len(node))
        for key in keys:
            found.append((node, key))
            if isinstance(node[key], dict | list):
                waiting.append(node[key])
    return found


def _other(value: Any, rng: Random) -> Any:
    """Another value: of another kind, extreme, deep, long or empty."""
    deep: Any = 0
    for _ in range(int(rng.integers(1, 60))):
        deep = [deep]
    kinds: list[Callable[[], Any]] = [
        lambda: None,
        lambda: bool(rng.integers(2)),
        lambda: float(rng.choice([1e308, -1e308, 1e-308, 0.0, -1.0, 1e12, 1e-12, np.nan, np.inf])),
        lambda: int(rng.choice([0, 1, 3, -1, 255, 2**16, 2**31, 2**32, 2**53, 10**18])),
        lambda: 10**309,
        lambda: str(
            rng.choice(
                ["", "table", "\0", "\x1b[31m", "../../etc", "ü\u202e", "a" * 5000, "b\ud800"]
            )
        ),
        lambda: deep,
        dict,
        list,
        lambda: [value, value],
        lambda: {"name": value},
        lambda: value * 1.0000001 if isinstance(value, float) else value,
        lambda: -value if isinstance(value, int | float) else value,
    ]
    return kinds[int(rng.integers(len(kinds)))]()


def rezipped(content: bytes, rng: Random) -> bytes:
    """A zip with a member damaged, dropped, renamed, doubled or very large."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            members = {name: archive.read(name) for name in archive.namelist()}
    except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError, RuntimeError, EOFError):
        return flipped(content, rng)
    except Exception:  # a damaged member: whatever zlib says
        return flipped(content, rng)
    if not members:
        return flipped(content, rng)
    name = str(rng.choice(list(members)))
    change = int(rng.integers(6))
    if change == 0:
        del members[name]
    elif change == 1:
        members["../" + name] = members.pop(name)
    elif change == 2:
        members[name] = members[name] + b" " * int(10 ** rng.integers(3, 8))
    elif change == 3:
        entity = b'<!DOCTYPE a [<!ENTITY b "cccccccccc"><!ENTITY d "&b;&b;&b;&b;&b;&b;&b;&b;">]>'
        members[name] = entity + members[name]
    else:
        members[name] = renumbered(members[name], rng)
    made = io.BytesIO()
    packing = [zipfile.ZIP_DEFLATED, zipfile.ZIP_STORED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA]
    kind = packing[int(rng.integers(4))]
    with zipfile.ZipFile(made, "w") as archive:
        for one, data in members.items():
            # an entry without a time: the same number makes the same file
            archive.writestr(zipfile.ZipInfo(one), data, kind)
    return made.getvalue()
