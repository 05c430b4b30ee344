"""A session: no vehicle, no file; what is said of a disk that fails, once; and when it is tried again."""

from __future__ import annotations

import os
import threading
from itertools import pairwise
from pathlib import Path

import pytest

from dialects.enums import Severity
from groundstation.recording.log_folder import LogFolder, LogLimits
from groundstation.recording.session_recorder import RETRY, RETRY_MAX, STEADY, SessionRecorder
from link.tlog.tlog import read_records
from tests.link.frames import demand

PLENTY = 10**12
TICK = 0.1


class Session:
    """A recorder on a disk whose free space can be set, in steps of the station's tick."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.free = PLENTY
        self.now = 1000.0
        self.said: list[str] = []
        limits = LogLimits(100_000, 10**9)
        self.session = SessionRecorder(LogFolder(path, limits, free=lambda path: self.free))

    def step(self, frames: list[bytes] | None = None, *, vehicle: bool = True) -> None:
        self.now += TICK
        if frames:
            self.session.recorder.add(self.now, frames)
        news = self.session.tick(self.now, vehicle=vehicle)
        self.said += [each.text for each in news]
        assert all(each.severity is Severity.WARNING for each in news if each.text.startswith("not recording"))
        done = threading.Event()
        self.session.recorder.check_writable(done.set)
        assert done.wait(60)

    def run(self, seconds: float) -> None:
        for number in range(round(seconds / TICK)):
            self.step([demand(number % 256)])

    def frames(self) -> list[bytes]:
        return [
            record.raw
            for name in sorted(os.listdir(self.path))
            for record in read_records((self.path / name).read_bytes())
        ]


@pytest.fixture
def session(tmp_path: Path) -> Session:
    return Session(tmp_path / "logs")


def test_without_a_vehicle_there_is_no_file(session: Session) -> None:
    for number in range(100):
        session.step([demand(number)], vehicle=False)
    session.session.close()
    assert not session.path.exists()
    assert session.said == []
    assert session.session.view(session.now) is None


def test_the_file_begins_shortly_before_the_vehicle_and_keeps_up(session: Session) -> None:
    session.step([demand(1)], vehicle=False)
    session.step([demand(2)])
    session.step([demand(3)])
    assert session.frames() == [demand(1), demand(2), demand(3)], "in the file without an end"
    session.step([demand(4)])
    view = session.session.view(session.now)
    assert view is not None
    assert (view.problem, view.size, os.listdir(session.path)) == ("", 4 * (8 + 23), [os.path.basename(view.path)])
    assert session.said == [f"recording to {view.path}"]
    session.session.close()


def test_full_disk_is_told_once_and_recording_resumes_with_space(session: Session) -> None:
    session.run(1.0)
    session.free = 0
    session.session._folder._log._synced -= 10.0  # type: ignore[union-attr]  # the check is due
    session.run(RETRY + 5.0)
    (failed,) = session.said[1:]
    assert failed.startswith(f"not recording: less than 32 MiB free ({session.path})")
    view = session.session.view(session.now)
    assert view is not None
    assert view.problem == f"not recording: less than 32 MiB free ({session.path})"
    session.free = PLENTY
    session.run(2 * RETRY + 2.0)
    view = session.session.view(session.now)
    assert view is not None
    assert (view.problem, len(os.listdir(session.path))) == ("", 2)
    session.run(STEADY)
    assert session.said[2:] == [f"recording again to {view.path}"]
    session.free = 0
    session.session._folder._log._synced -= 10.0  # type: ignore[union-attr]
    session.run(1.0)
    assert len(session.said) == 4, "a new failure is said again"
    session.session.close()


def test_a_disk_that_keeps_failing_is_told_once_and_tried_rarely(session: Session) -> None:
    tries: list[float] = []
    folder = session.session._folder

    def failing(path: Path) -> int:
        tries.append(session.now)
        return 0

    folder._free = failing
    session.run(3 * RETRY_MAX)
    assert len(session.said) == 1
    gaps = [after - before for before, after in pairwise(tries)]
    assert gaps[0] == pytest.approx(RETRY, abs=0.5)
    assert all(after >= 1.9 * before or after >= RETRY_MAX for before, after in pairwise(gaps))
    session.session.close()


def test_a_folder_that_is_removed_comes_back(session: Session) -> None:
    session.run(1.0)
    for name in os.listdir(session.path):
        (session.path / name).unlink()
    session.path.rmdir()
    session.session._folder._log._synced -= 10.0  # type: ignore[union-attr]
    session.run(RETRY + 3.0)
    assert session.said[1].startswith("not recording: the file was removed")
    assert len(session.frames()) > 20
    session.session.close()
