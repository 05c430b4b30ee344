"""The replay process: what it shows of logs of several programs, that it has no links, and files it cannot read."""

from __future__ import annotations

import os
import struct
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from pymavlink.dialects.v20 import ardupilotmega

from groundstation.client import StationClient, StationError
from groundstation.host.replay_process import ReplayError, open_log
from groundstation.intents import replay as r
from groundstation.intents.watch import Watch
from groundstation.snapshot import Snapshot
from groundstation.views.base import View
from groundstation.views.replay import ReplayRequest, ReplayView
from tests.groundstation.recorded_station import RECORDINGS
from tests.groundstation.replay.logs import drive_log, indexed, open_desk
from tests.waits import wait_until

pytestmark = pytest.mark.e2e


class Watcher:
    """Reads what a replay sends."""

    def __init__(self, client: StationClient) -> None:
        self.client = client
        self.snapshot = Snapshot()
        self.views: dict[type[View], View] = {}

    def see(self, condition: Callable[[Snapshot], object]) -> Snapshot:
        """Read until a snapshot is so."""

        def seen() -> bool:
            self.snapshot = self.client.receive() or self.snapshot
            self.views |= {type(view): view for view in self.client.pop_views()}
            return self.snapshot.replay is not None and bool(condition(self.snapshot))

        wait_until(seen)
        return self.snapshot

    @property
    def position(self) -> float:
        """Of the newest snapshot, s."""
        return self.snapshot.replay.position if self.snapshot.replay else -1.0


@contextmanager
def replay(file: Path, at: str = "") -> Iterator[Watcher]:
    client = StationClient.start_replay(file, at=at)
    try:
        yield Watcher(client)
    finally:
        client.close()


def internet_sockets(pid: int) -> set[str]:
    """Return the inodes of TCP and UDP sockets of a process."""
    links = {os.readlink(each) for each in Path(f"/proc/{pid}/fd").iterdir()}
    opened = {link[8:-1] for link in links if link.startswith("socket:[")}
    tables = ("tcp", "udp", "tcp6", "udp6")
    lines = [line.split() for name in tables for line in Path(f"/proc/{pid}/net/{name}").read_text().splitlines()[1:]]
    return opened & {line[9] for line in lines}


def test_a_replay_shows_a_log_seeks_and_has_no_link_at_all(tmp_path: Path) -> None:
    file = tmp_path / "drive.tlog"
    data = bytes(drive_log().data)
    file.write_bytes(data[:-9])
    with replay(file, at="35") as watcher:
        shown = watcher.see(lambda now: now.vehicle and now.vehicle.mode == "AUTO")
        assert shown.replay is not None
        assert (shown.replay.file, shown.replay.position) == ("drive.tlog", 35.0)
        watcher.client.send(Watch((ReplayRequest(40, 5),)), r.ReplayGoTo("0:15"))
        watcher.see(lambda now: watcher.position == 15.0 and ReplayView in watcher.views)
        watcher.client.send(r.ReplayPlay(playing=True))
        watcher.see(lambda now: watcher.position > 15.3)
        assert internet_sockets(watcher.client.pid) == set()
        file.write_bytes(data)  # it grows
        watcher.see(lambda now: now.replay and now.replay.duration > 59.85)
    assert not watcher.client.alive


def test_a_log_of_a_real_rover() -> None:
    with replay(RECORDINGS / "ardurover.tlog") as watcher:
        watcher.client.send(r.ReplaySearch("armed==1"))
        shown = watcher.see(lambda now: now.vehicle and now.vehicle.armed)
        assert shown.vehicle is not None
        assert shown.vehicle.name == "ArduPilot rover 1"


def test_a_log_as_pymavlink_writes_it() -> None:
    """MAVLink 1 and 2, signed frames, the link number in the lowest bits of the time, a dialect that ours lacks."""
    data = bytearray()
    mav = ardupilotmega.MAVLink(None, srcSystem=7, srcComponent=1)
    for second in range(20):
        version_1 = second % 2 == 0
        mav.signing.sign_outgoing = second > 10 and not version_1
        mav.signing.secret_key = bytes(32)
        beat = mav.heartbeat_encode(10, 3, 81 if second < 12 else 209, 0, 4, 3)
        for message in (beat, mav.rangefinder_encode(1.0, 2.0), mav.vfr_hud_encode(0, second, 0, 0, 0, 0)):
            stamp = int((1_700_000_000 + second) * 1e6) & ~3 | 1
            data += struct.pack(">Q", stamp) + message.pack(mav, force_mavlink1=version_1)
    index = indexed(bytes(data))
    assert (index.frames, index.damaged, index.tail) == (60, 0, 0)
    desk = open_desk(bytes(data), at="15.5")
    vehicle = desk.snapshot().vehicle
    assert vehicle is not None
    assert (vehicle.system, vehicle.armed, vehicle.speed) == (7, True, 15.0)


def test_files_that_are_no_log_get_one_line(tmp_path: Path) -> None:
    (tmp_path / "empty.tlog").touch()
    (tmp_path / "text.tlog").write_text("some text\n" * 1000)
    os.mkfifo(tmp_path / "pipe.tlog")
    words = {
        tmp_path: "is a folder", tmp_path / "empty.tlog": "is empty", tmp_path / "text.tlog": "is not a telemetry log",
        tmp_path / "none.tlog": "no such file: name a telemetry log", tmp_path / "pipe.tlog": "is not a regular file",
    }  # fmt: skip
    for path, text in words.items():
        with pytest.raises(ReplayError, match=text) as caught:
            open_log(path)
        assert "\n" not in str(caught.value)
    with pytest.raises(StationError, match=r"text\.tlog: is not a telemetry log"):
        StationClient.start_replay(tmp_path / "text.tlog")
