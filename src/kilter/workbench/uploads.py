"""Files that are dropped on the page: receive each into the temporary folder of the session."""

from __future__ import annotations

import asyncio
import contextlib
import os
import secrets
from pathlib import Path
from typing import Any

from starlette.requests import ClientDisconnect, Request

from kilter.errors import InputError
from kilter.files.limits import MOST_BYTES

PATIENCE = 20.0
"""Time without data after which an upload is ended [s]."""
SLOWEST = 10_000.0
"""Rate below which an upload is ended, once `PATIENCE` has passed [bytes/s]."""
LONGEST_NAME = 200
"""Longest name of a file or folder [bytes]; the names of other files are made from it."""


async def receive_upload(request: Request, uploads: Path) -> str:
    """Write the body of a request to a file; return the path to open, relative to the folder.

    The query has the name of the file, and of its folder if a folder was dropped. A file of the
    same name is replaced once the new file is complete.

    Raises `InputError` if a name is not usable, the file is too large or too slow, or it cannot be
    written.
    """
    folder, path = _place(uploads, request.query_params)
    partial = uploads / f".{secrets.token_hex(8)}.partial"  # two uploads may have the same name
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        await _receive(request, partial)
        os.replace(partial, path)
    except ClientDisconnect:
        raise InputError("the upload ended too early", hint="drop the file again") from None
    except TimeoutError:
        raise InputError("the upload is too slow", hint="open it with 'kilter view FILE'") from None
    except OSError as error:
        raise InputError(
            f"the file cannot be kept: {error.strerror}", hint="rename it, or free space"
        ) from None
    finally:
        with contextlib.suppress(OSError):
            partial.unlink(missing_ok=True)
    return folder or path.relative_to(uploads).as_posix()


def _place(uploads: Path, query: Any) -> tuple[str, Path]:
    """Name of the folder that was dropped, and path of the file in the temporary folder.

    Raises `InputError` if a name is no plain file name.
    """
    name, folder = query.get("name", ""), query.get("folder", "")
    for word in (name, folder):
        plain = word.isprintable() and not word.startswith(".") and "\\" not in word
        # a letter has up to 4 bytes, so the second limit rejects no name that the first accepts
        if not plain or Path(word).name != word or len(word.encode()) > LONGEST_NAME:
            raise InputError(f"the name {word!r:.60} is not usable", hint="rename the file")
    if not name:
        raise InputError("the uploaded file has no name", hint="rename the file")
    return folder, uploads / folder / name


async def _receive(request: Request, path: Path) -> None:
    """Write the body of a request to a new file."""
    loop = asyncio.get_running_loop()
    begun, size = loop.time(), 0
    async with asyncio.timeout(PATIENCE) as limit:
        with path.open("xb") as file:
            async for piece in request.stream():
                size += len(piece)
                if size > MOST_BYTES:
                    raise InputError(
                        f"the file is larger than {MOST_BYTES // 10**6} MB",
                        hint="open it with 'kilter view FILE'",
                    )
                file.write(piece)
                now = loop.time()
                limit.reschedule(min(now, begun + size / SLOWEST) + PATIENCE)
