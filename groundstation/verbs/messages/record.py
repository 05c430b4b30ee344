"""`groundstation record`: writes what is heard on the links into a telemetry log."""

from __future__ import annotations

import argparse
import asyncio
import os
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.local_file import check_new_file
from groundstation.verbs.common.output import Output
from groundstation.verbs.session.session import VerbSession
from link.protocol.frame import read_header
from link.protocol.log_tap import LogTap
from link.tlog.raw_file import RawFile
from link.tlog.recorder import SLOW, Recorder
from link.tlog.scan import LogFrame
from link.tlog.tlog import read_log

PERIOD = 0.1
"""s between two looks at the disk and the clock; what has come is written each time."""


class FileRecording:
    """Records into one file. `ids` are our own, whose frames do not count as heard."""

    def __init__(self, path: str, ids: tuple[int, int]) -> None:
        self.path = path
        self.heard: Counter[tuple[int, int]] = Counter()
        """Frames of each system and component: those that came, in the end those that are in the file."""
        self.recorder = Recorder(period=PERIOD / 2)
        self.log_tap = LogTap(self._add, system=ids[0], component=ids[1], unsent=False)
        self._ids = ids

    def open(self) -> None:
        """Create the file. Raises VerbError."""
        try:
            descriptor = os.open(self.path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_CLOEXEC, 0o666)
        except OSError as error:
            raise VerbError(ExitCode.USAGE, f"{self.path}: {error.strerror}") from error
        self.recorder.start(lambda: RawFile(descriptor))

    def close(self) -> None:
        """Write the rest; remove the file if nothing was heard."""
        self.recorder.close()
        file = Path(self.path)
        if self.recorder.failure is not None:
            self._count_written(file)
        if not self.heard and file.is_file():
            file.unlink(missing_ok=True)

    def _count_written(self, path: Path) -> None:
        """Count what is in the file: the last frames did not fit."""
        self.heard.clear()
        if path.is_file():
            with path.open("rb") as file:
                frames = [each for part in read_log(file) for each in part if isinstance(each, LogFrame)]
            self.heard.update((each.system, each.component) for each in frames)
            self.heard.pop(self._ids, None)

    def _add(self, now: float, frames: Sequence[bytes]) -> None:
        for raw in frames:
            header = read_header(raw, 0)
            if header is not None and (header.system, header.component) != self._ids:
                self.heard[header.system, header.component] += 1
        self.recorder.add(now, frames)


def open_recording(options: argparse.Namespace, ids: tuple[int, int]) -> LogTap:
    """Return what takes the frames. Raises VerbError if the file cannot be made."""
    check_new_file(options.file, overwrite=options.yes)
    options.recording = FileRecording(options.file, ids)
    tap: LogTap = options.recording.log_tap
    return tap


async def record(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Record until the time is over or a signal comes; then print what is in the file."""
    recording: FileRecording = options.recording
    recording.open()
    output.note(f"recording to {recording.path}{'' if options.seconds else ' until Ctrl-C'}")
    try:
        while recording.recorder.failure is None and not _is_over(session, options.seconds):
            await asyncio.sleep(PERIOD)
            recording.recorder.tick(session.now)
    finally:
        recording.close()
        _report(recording, session.now - session.began, output)
    return _end(recording, session)


def _is_over(session: VerbSession, seconds: float | None) -> bool:
    return seconds is not None and session.now - session.began >= seconds


def _report(recording: FileRecording, seconds: float, output: Output) -> None:
    sources = ", ".join(f"{system}/{component}" for system, component in sorted(recording.heard))
    count = recording.heard.total()
    if count:
        output.line(f"{recording.path}: {count} messages of {sources} in {seconds:.1f} s")
    output.record(file=recording.path, messages=count, sources=sources, seconds=round(seconds, 3))


def _end(recording: FileRecording, session: VerbSession) -> int:
    """Return the exit code. Raises VerbError if not all is in the file."""
    failure, lost = recording.recorder.failure, recording.recorder.lost
    if failure is not None:
        what = "the file ends there" if recording.heard else "nothing was recorded"
        raise VerbError(ExitCode.PARTLY, f"{recording.path}: {failure}; {what}")
    if lost:
        raise VerbError(ExitCode.PARTLY, f"{recording.path}: {SLOW}: {lost}")
    if not recording.heard:
        raise VerbError(ExitCode.NO_VEHICLE, f"no file, because nothing was heard{session.describe_links()}")
    return ExitCode.DONE
