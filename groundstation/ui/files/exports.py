"""Exports of logs that run beside the screens: each is a process, `mavhelm export` (verbs/files/export.py).

The screen's process does not load the dialect, and reading a log must not hold up its event loop, which renews the
lease.
"""

from __future__ import annotations

import asyncio
import json
import re
import sys
from collections import deque
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import msgspec

from groundstation.views.requests import RequestLine

SERVICE = "export"
LOG_SUFFIX = ".tlog"
KEPT = 4
"""Exports that have ended and are still listed."""
NAMES = "name.mcap .gpx .kml .jsonl .tlog, or a folder/ of tables; then from and to, if only a part: 0:31 0:44"
_TEXT = re.compile(
    r"(?P<name>\S.*?(?:\.(?P<suffix>mcap|gpx|kml|jsonl|tlog)|/))(?:\s+(?P<begin>\S+))?(?:\s+(?P<end>\S+))?"
)
WHERE = " in /"
"""Behind it a line names the file, which the task does already."""
_DONE, _PARTLY = 0, 8
"""Exit codes of the verb (groundstation/verbs/common/exit_codes.py, which loads the dialect)."""


class ExportRequest(msgspec.Struct, frozen=True):
    """What to write of which log."""

    log: Path
    output: Path
    format: str
    begin: str = ""
    end: str = ""
    """As `--from` and `--to` take them."""

    def arguments(self, *, overwrite: bool) -> list[str]:
        """Return the arguments of `mavhelm export`."""
        words = [str(self.log), f"--{self.format}", str(self.output), "--json", "--progress"]
        words += ["--from", self.begin] if self.begin else []
        words += ["--to", self.end] if self.end else []
        return words + ["--yes"] * overwrite


def parse_request(text: str, log: Path, folder: Path) -> ExportRequest | None:
    """Return what a text such as "drive.mcap 0:31 0:44" asks for; None if its ending names no format."""
    found = _TEXT.fullmatch(text.strip())
    if found is None:
        return None
    output = folder / Path(found["name"]).expanduser()
    return ExportRequest(log, output, found["suffix"] or "csv", found["begin"] or "", found["end"] or "")


class Exports:
    """The exports of this program. Lives as long as the app."""

    def __init__(self, dialect: str | None = None) -> None:
        self._dialect = dialect
        self._lines: dict[int, RequestLine] = {}
        self._processes: dict[int, asyncio.subprocess.Process] = {}
        self._tasks: dict[int, asyncio.Task[None]] = {}
        self._cancelled: set[int] = set()
        self._ended: deque[RequestLine] = deque(maxlen=KEPT)

    @property
    def lines(self) -> tuple[RequestLine, ...]:
        """What runs and what has ended, as the requests to a vehicle."""
        return (*self._lines.values(), *self._ended)

    def start(self, number: int, request: ExportRequest, *, overwrite: bool = False) -> None:
        """Start an export in the running event loop. `number` is that of no other request."""
        self._lines[number] = RequestLine(number, "running", f"export {request.output.name}", service=SERVICE)
        words = request.arguments(overwrite=overwrite) + (["--dialect", self._dialect] if self._dialect else [])
        self._tasks[number] = asyncio.get_running_loop().create_task(self._run(number, words))

    def cancel(self, number: int) -> bool:
        """Stop an export, which then writes nothing; return whether there is one of this number."""
        if number not in self._lines:
            return False
        self._cancelled.add(number)
        if number in self._processes:
            self._terminate(number)
        return True

    def _terminate(self, number: int) -> None:
        with suppress(ProcessLookupError):
            self._processes[number].terminate()

    async def _run(self, number: int, words: Sequence[str]) -> None:
        pipe = asyncio.subprocess.PIPE
        try:
            process = await asyncio.create_subprocess_exec(
                sys.executable, "-m", "groundstation", "export", *words, stdin=asyncio.subprocess.DEVNULL,
                stdout=pipe, stderr=pipe, start_new_session=True,
            )  # fmt: skip
        except OSError as error:
            self._end(number, "refused", error.strerror or str(error))
            return
        self._processes[number] = process
        if number in self._cancelled:
            self._terminate(number)
        try:
            await self._follow(number, process)
        except asyncio.CancelledError:  # the program ends: the loop would kill the process, which leaves half a file
            self._terminate(number)
            await process.wait()
            raise

    async def _follow(self, number: int, process: asyncio.subprocess.Process) -> None:
        assert process.stdout is not None
        assert process.stderr is not None
        errors = asyncio.ensure_future(process.stderr.read())
        async for line in process.stdout:
            self._advance(number, line)
        self._finish(number, await process.wait(), (await errors).decode("utf-8", "replace"))

    def _advance(self, number: int, line: bytes) -> None:
        record = json.loads(line)
        if "done" in record:
            self._lines[number] = msgspec.structs.replace(
                self._lines[number], done=record["done"], total=record["total"]
            )

    def _finish(self, number: int, code: int, errors: str) -> None:
        told = [line.removeprefix("mavhelm: ").partition(WHERE)[0] for line in errors.splitlines()]
        if number in self._cancelled and code not in (_DONE, _PARTLY):
            self._end(number, "cancelled", "nothing is written")
        elif code in (_DONE, _PARTLY):
            self._end(number, "accepted", "; ".join(told))
        else:
            self._end(number, "refused", told[-1] if told else f"the export ended with {code}")

    def _end(self, number: int, state: str, detail: str) -> None:
        line = self._lines.pop(number)
        self._processes.pop(number, None)
        self._tasks.pop(number, None)
        self._cancelled.discard(number)
        self._ended.append(msgspec.structs.replace(line, state=state, detail=detail))
