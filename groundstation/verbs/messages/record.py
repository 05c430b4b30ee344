"""`mavhelm record`: writes what is heard on the links into a telemetry log.

The verb collects frames, and its companion in the process of the user writes them, so that a slow disk delays no link.
"""

from __future__ import annotations

import argparse
import asyncio
import os
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from groundstation.verbs.common.channel import ChannelEndedError, CompanionChannel
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
LARGEST = 1 << 16
"""Bytes of frames after which they are handed over at once: a packet to a shell has room for four times as many."""


class FileRecording:
    """Records into one file. `ids` are our own, whose frames do not count as heard."""

    def __init__(self, path: str, ids: tuple[int, int]) -> None:
        self.path = path
        self.heard: Counter[tuple[int, int]] = Counter()
        """Frames of each system and component: those that came, in the end those that are in the file."""
        self.recorder = Recorder(period=PERIOD / 2)
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

    def add(self, now: float, frames: Sequence[bytes]) -> None:
        """Record frames of a moment; costs no more than a list."""
        for raw in frames:
            header = read_header(raw, 0)
            if header is not None and (header.system, header.component) != self._ids:
                self.heard[header.system, header.component] += 1
        self.recorder.add(now, frames)


class FrameCollector:
    """Collects the frames of the links for the companion. `ids` are ours, whose frames do not count as heard."""

    def __init__(self, ids: tuple[int, int]) -> None:
        self.ids = ids
        self.companion: CompanionChannel | None = None
        """Gets the frames, once the verb has begun."""
        self.log_tap = LogTap(self._add, system=ids[0], component=ids[1], unsent=False)
        self._frames: list[tuple[float, Sequence[bytes]]] = []
        self._size = 0

    def hand_over(self) -> None:
        """Send times and frames since the last call."""
        if self._frames and self.companion is not None:
            self.companion.send(self._frames)
            self._frames, self._size = [], 0

    def _add(self, now: float, frames: Sequence[bytes]) -> None:
        self._frames.append((now, frames))
        self._size += sum(map(len, frames))
        if self._size >= LARGEST:
            self.hand_over()


def prepare(options: argparse.Namespace) -> None:
    """Check that the file can be made. Raises VerbError."""
    check_new_file(options.file, overwrite=options.yes)


def collect(options: argparse.Namespace, ids: tuple[int, int]) -> LogTap:
    """Return what takes the frames."""
    options.frames = FrameCollector(ids)
    tap: LogTap = options.frames.log_tap
    return tap


async def record(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Record until the time is over or a signal comes; the companion says what is in the file."""
    frames: FrameCollector = options.frames
    session.companion.send(frames.ids)
    frames.companion = session.companion
    output.note(f"recording to {options.file}{'' if options.seconds else ' until Ctrl-C'}")
    try:
        while options.seconds is None or session.now - session.began < options.seconds:
            await _receive_soon(session.companion)  # only its end comes
            frames.hand_over()
    finally:
        frames.hand_over()
    session.companion.send(session.describe_links())
    return ExitCode.DONE


async def _receive_soon(channel: CompanionChannel) -> Any:
    """Return what comes within PERIOD, or None. Raises VerbError and ChannelEndedError, as the channel does."""
    try:
        async with asyncio.timeout(PERIOD):
            return await channel.receive()
    except TimeoutError:
        return None


async def write(options: argparse.Namespace, output: Output, verb: CompanionChannel) -> None:
    """Write what the verb collects, as its companion, and print what is in the file. Raises VerbError."""
    system, component = await verb.receive()
    recording, now = FileRecording(options.file, (system, component)), asyncio.get_running_loop().time
    recording.open()
    began, silence = now(), None
    try:
        while recording.recorder.failure is None:
            batch = await _receive_soon(verb)
            if isinstance(batch, str):
                silence = batch
            else:
                for at, frames in batch or ():
                    recording.add(at, frames)
            recording.recorder.tick(now())
    except ChannelEndedError:
        pass
    finally:
        recording.close()
        _report(recording, now() - began, output)
    if silence is not None or recording.recorder.failure is not None:  # else its user has interrupted it
        _check(recording, silence or "")


def _report(recording: FileRecording, seconds: float, output: Output) -> None:
    sources = ", ".join(f"{system}/{component}" for system, component in sorted(recording.heard))
    count = recording.heard.total()
    if count:
        output.line(f"{recording.path}: {count} messages of {sources} in {seconds:.1f} s")
    output.record(file=recording.path, messages=count, sources=sources, seconds=round(seconds, 3))


def _check(recording: FileRecording, silence: str) -> None:
    """Raise VerbError if not all is in the file. `silence`: why nothing was heard, behind ": "; "" if not known."""
    failure, lost = recording.recorder.failure, recording.recorder.lost
    if failure is not None:
        what = "the file ends there" if recording.heard else "nothing was recorded"
        raise VerbError(ExitCode.PARTLY, f"{recording.path}: {failure}; {what}")
    if lost:
        raise VerbError(ExitCode.PARTLY, f"{recording.path}: {SLOW}: {lost}")
    if not recording.heard:
        raise VerbError(ExitCode.NO_VEHICLE, f"no file, because nothing was heard{silence}")
