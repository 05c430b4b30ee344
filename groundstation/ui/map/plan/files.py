"""Opens and saves plan files through a process of its own (verbs/mission/plan_converter.py)."""

from __future__ import annotations

import asyncio
import sys
from pathlib import Path

import msgspec

from groundstation.formats.layer import LayerDocument
from groundstation.views.plan import PlanDocument

CONVERTER = "groundstation.verbs.mission.plan_converter"
TIMEOUT = 30.0
"""s for a file of 16 MB on a slow machine."""


class MapFileError(Exception):
    """A file cannot be read or written; the message is one line for the user."""


async def open_plan(path: Path) -> PlanDocument:
    """Return the plans of a file. Raises MapFileError."""
    return msgspec.msgpack.decode(await _convert(b"", "read", str(path)), type=PlanDocument)


async def open_layer(path: Path) -> LayerDocument:
    """Return the shapes of a GeoJSON file. Raises MapFileError."""
    return msgspec.msgpack.decode(await _convert(b"", "layer", str(path)), type=LayerDocument)


async def save_plan(path: Path, document: PlanDocument, *, replace: bool = False) -> str:
    """Write plans to a file, whole or not at all; return what the format cannot hold. Raises MapFileError."""
    told = await _convert(msgspec.msgpack.encode(document), "write", str(path), *(["replace"] if replace else []))
    return told.decode()


async def _convert(data: bytes, *arguments: str) -> bytes:
    pipe = asyncio.subprocess.PIPE
    process = await asyncio.create_subprocess_exec(
        sys.executable, "-m", CONVERTER, *arguments, stdin=pipe, stdout=pipe, stderr=pipe
    )
    try:
        out, errors = await asyncio.wait_for(process.communicate(data), TIMEOUT)
    except TimeoutError:
        process.kill()
        raise MapFileError(f"{arguments[1]}: not done within {TIMEOUT:.0f} s") from None
    if process.returncode:
        lines = errors.decode("utf-8", "replace").splitlines() or [f"the converter ended with {process.returncode}"]
        raise MapFileError(lines[-1])
    return out
