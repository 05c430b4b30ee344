"""The vehicle as a real process records its drives: fetched over the air, and read by pymavlink."""

from __future__ import annotations

import hashlib
import os
import resource
import signal
from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from pymavlink import mavftp, mavutil

from dialects import messages as m
from dialects.axes import Axes
from dialects.enums import Command
from link.core import Peer, Received
from link.protocol.frame import Frame, payload_of
from link.protocol.framer import Framer
from link.services.ftp.client import FtpClient
from link.services.ftp.job import FtpOutcome
from link.tlog.tlog import Record, read_records
from tests.ports import free_port
from tests.vehicle.ground import Ground, drive, running
from vehicle.params import TABLE
from vehicle.storage.tlog_files import log_number, log_time

pytestmark = pytest.mark.e2e

PEER = Peer(0, "vehicle")


class Reader(Ground):
    """A ground station that fetches files and logs."""

    def fetch(self, ask: Callable[[FtpClient], object]) -> FtpOutcome:
        """What our own FTP client brings."""
        client = FtpClient(255, 190, target_system=1)
        outcomes: list[FtpOutcome] = []
        ask(client)
        now, read_to = 0.0, len(self.heard)

        def step() -> bool:
            nonlocal now, read_to
            for outgoing in client.messages_to_send():
                self.say(outgoing.message)
            news, read_to = self.heard[read_to:], len(self.heard)
            for message in news:
                client.receive(Received(message, 1, 1, 0, PEER, True), now)
            now += 0.005
            client.tick(now)
            outcomes.extend(client.outcomes())
            return bool(outcomes)

        self.wait(step, "the file comes")
        return outcomes[0]

    def download(self, path: str) -> bytes:
        """A file by FTP."""
        outcome = self.fetch(lambda client: client.download(path, 0.0))
        assert outcome.done, outcome
        return outcome.data

    def log_list(self) -> list[Any]:
        """What LOG_REQUEST_LIST brings, by number."""
        before = len(self.heard)
        self.say(m.LogRequestList(1, 1, 0, 0xFFFF))

        def entries() -> dict[int, Any]:
            return {each.id: each for each in self.heard[before:] if isinstance(each, m.LogEntry)}

        self.wait(lambda: any(len(entries()) == max(1, each.num_logs) for each in entries().values()), "a list of logs")
        return [entry for _, entry in sorted(entries().items()) if entry.num_logs]

    def log_data(self, number: int, size: int) -> bytes:
        """A log by LOG_REQUEST_DATA, as much as the list told of it."""
        before = len(self.heard)
        self.say(m.LogRequestData(1, 1, number, 0, size))

        def data() -> bytes:
            pieces = sorted((each.ofs, each) for each in self.heard[before:] if isinstance(each, m.LogData))
            return b"".join(bytes(each.data[: each.count]) for _, each in pieces)

        self.wait(lambda: len(data()) >= size, "all of the log")
        return data()

    def disarm(self) -> None:
        """Until it is."""
        self.demand = None

        def disarmed() -> bool:
            self.say(m.CommandLong(1, 1, Command.COMPONENT_ARM_DISARM, 0, 0, 0, 0, 0, 0, 0, 0))
            return not self.armed

        self.wait(disarmed, "the vehicle disarms")


def logs_of(folder: Path) -> list[Path]:
    """The logs, the oldest first."""
    return sorted(folder.glob("*.tlog"))


def grown(folder: Path, size: int = 0) -> bool:
    """Is there a log longer than this?"""
    return any(path.stat().st_size > size for path in logs_of(folder))


def by_pymavlink(path: Path) -> list[Any]:
    """All messages, as mavlogdump, MAVProxy and MAVExplorer read them."""
    log = mavutil.mavlink_connection(str(path))  # type: ignore[no-untyped-call]
    found = []
    while (message := log.recv_match()) is not None:
        found.append(message)
    log.close()
    return found


def sources(messages: Sequence[Any]) -> Counter[tuple[str, int]]:
    """How many of what from whom."""
    return Counter((message.get_type(), message.get_srcSystem()) for message in messages)


def test_a_drive_is_recorded_fetched_three_ways_and_read(tmp_path: Path) -> None:
    folder = tmp_path / "state" / "logs"
    with Reader() as ground, running(tmp_path, "--sim", ground.endpoint, "--state", str(folder.parent)) as vehicle:
        vehicle.ready()
        drive(ground, vehicle)
        ground.wait(lambda: grown(folder, 3000), "a log with something in it")
        [growing] = ground.log_list()
        assert growing.size <= logs_of(folder)[0].stat().st_size
        part = ground.log_data(0, growing.size)
        whole = ground.download(f"/logs/{logs_of(folder)[0].name}")
        assert len(whole) >= growing.size  # it has grown meanwhile
        assert whole.startswith(part)
        ground.disarm()
        vehicle.process.send_signal(signal.SIGTERM)
        vehicle.ended()
    [log] = logs_of(folder)
    assert log_number(log.name) == 1
    assert abs(growing.time_utc - log.stat().st_mtime) < 120
    assert log_time(log.name) == growing.time_utc
    assert log.read_bytes().startswith(whole)
    messages = by_pymavlink(log)
    found = sources(messages)
    assert found["MANUAL_CONTROL", 255] > 3
    assert found["COMMAND_LONG", 255] >= 2
    assert found["COMMAND_ACK", 1] >= 2
    assert found["SERVO_OUTPUT_RAW", 1] >= 1
    assert found["FILE_TRANSFER_PROTOCOL", 1] == found["LOG_DATA", 1] == 0
    texts = [message.text for message in messages if message.get_type() == "STATUSTEXT"]
    assert "Armed by GCS 255, mode MANUAL" in texts
    assert "Disarmed: by GCS 255" in texts
    stamps = [each.microseconds for each in read_records(log.read_bytes())]
    assert stamps == sorted(stamps)


def test_the_vehicles_actions_are_recorded_though_nobody_listens(tmp_path: Path) -> None:
    folder = tmp_path / "logs"
    words = (f"udpin:127.0.0.1:{free_port()}", "--tlog", str(folder), "--param", "LOG_DISARMED=1")
    with Ground() as ground, running(tmp_path, "--sim", *words) as vehicle:
        vehicle.ready()
        ground.wait(lambda: recorded(folder)["PARAM_VALUE", 1] >= len(TABLE), "all parameters")
        for kind in (("SERVO_OUTPUT_RAW", 1), ("ATTITUDE", 1), ("HEARTBEAT", 1), ("UNKNOWN_46001", 0)):
            ground.wait(lambda kind=kind: recorded(folder)[kind] >= 3, str(kind))  # type: ignore[misc]
        assert not vehicle.process.poll()


def recorded(folder: Path) -> Counter[tuple[str, int]]:
    """What is in the log so far."""
    return sources([message for path in logs_of(folder) for message in by_pymavlink(path)])


def test_each_message_is_recorded_once_for_all_who_listen(tmp_path: Path) -> None:
    folder = tmp_path / "logs"
    with Ground() as one, Ground() as other:
        words = (one.endpoint, other.endpoint, "--tlog", str(folder), "--param", "LOG_DISARMED=1")
        with running(tmp_path, "--sim", *words) as vehicle:
            vehicle.ready()
            for ground in (one, other):
                ground.wait(partial(told, ground), "telemetry")
            one.wait(lambda: recorded(folder)["ATTITUDE", 1] >= 5, "a log with something in it")
    frames = [frame for frame in map(framed, read_records(logs_of(folder)[0].read_bytes())) if frame[1] == 1]
    times = [payload_of(raw)[:4] for message_id, *_, raw in frames if message_id == m.Attitude.id]
    assert len(times) == len(set(times)) >= 5
    numbers = [sequence for _, _, _, sequence, _ in frames]
    assert numbers == [number % 256 for number in range(len(numbers))]


def told(ground: Ground) -> bool:
    """Has it got telemetry?"""
    return sum(isinstance(each, m.Attitude) for each in ground.heard) >= 3


def framed(record: Record) -> Frame:
    """The frame of a record."""
    [frame] = Framer(stream=False, unknown=True).feed(record.raw, 0.0)
    return frame


def test_pymavlinks_own_client_fetches_a_log(tmp_path: Path) -> None:
    folder = tmp_path / "logs"
    folder.mkdir()
    content = os.urandom(70_000)
    (folder / "00000003.tlog").write_bytes(content)
    port = free_port()
    with running(tmp_path, "--sim", f"udpout:127.0.0.1:{port}", "--tlog", str(folder)) as vehicle:
        vehicle.ready()
        master = mavutil.mavlink_connection(  # type: ignore[no-untyped-call]
            f"udpin:127.0.0.1:{port}", source_system=255, source_component=190
        )
        try:
            assert master.wait_heartbeat(timeout=60)
            master.mav.heartbeat_send(6, 8, 0, 0, 4)
            got: list[bytes] = []
            client = mavftp.MAVFTP(master, 1, 1)
            client.cmd_get(["/logs/00000003.tlog"], callback=lambda file: got.append(file.read()))
            client.process_ftp_reply("get", timeout=60)
            assert [hashlib.sha256(data).digest() for data in got] == [hashlib.sha256(content).digest()]
        finally:
            master.close()


def test_a_killed_vehicle_leaves_a_log_that_can_be_read(tmp_path: Path) -> None:
    folder = tmp_path / "logs"
    with Ground() as ground, running(tmp_path, "--sim", ground.endpoint, "--tlog", str(folder)) as vehicle:
        vehicle.ready()
        drive(ground, vehicle)
        ground.wait(lambda: told_of(recorded(folder)), "a log with something in it")
        vehicle.process.kill()
        vehicle.process.wait(60)
    [log] = logs_of(folder)
    found = sources(by_pymavlink(log))
    assert told_of(found)
    assert found["BAD_DATA", 0] == 0
    # And the next drive is another log.
    with Ground() as ground, running(tmp_path, "--sim", ground.endpoint, "--tlog", str(folder)) as vehicle:
        vehicle.ready()
        ground.arm()
        ground.wait(lambda: len(logs_of(folder)) == 2, "a second log")
    assert [log_number(each.name) for each in logs_of(folder)] == [1, 2]


def told_of(found: Counter[tuple[str, int]]) -> bool:
    """Are driver and vehicle in the log?"""
    return found["MANUAL_CONTROL", 255] > 3 and found["HEARTBEAT", 1] >= 1


def test_log_disarmed_and_erase(tmp_path: Path) -> None:
    folder = tmp_path / "logs"
    folder.mkdir()
    (folder / "00000005.tlog").write_bytes(b"old")
    words = ("--sim", "--tlog", str(folder), "--param", "LOG_DISARMED=1")
    with Reader() as ground, running(tmp_path, *words, ground.endpoint) as vehicle:
        vehicle.ready()
        ground.wait(lambda: grown(folder, 500), "it records")
        assert ground.log_list()[0].size == 3
        ground.say(m.CommandLong(1, 1, Command.REQUEST_OPERATOR_CONTROL, 0, 1, 0, 0, 0, 0, 0, 0))
        ground.say(m.LogErase(1, 1))
        ground.wait(lambda: "Logs erased by GCS 255" in ground.texts(), "the erasing is told")
        ground.wait(lambda: len(logs_of(folder)) == 1, "the old log goes")
        assert [log_number(each.name) for each in logs_of(folder)] == [6]
        name = logs_of(folder)[0].name
        refused = ground.fetch(lambda client: client.download(f"/logs/{name}x", 0.0))
        assert not refused.done


def test_a_disk_that_takes_no_more_is_told_and_the_wheels_go_on(tmp_path: Path) -> None:
    folder = tmp_path / "logs"
    with Ground() as ground, running(tmp_path, "--sim", ground.endpoint, "--tlog", str(folder)) as vehicle:
        vehicle.ready()
        resource.prlimit(vehicle.process.pid, resource.RLIMIT_FSIZE, (6000, 6000))
        drive(ground, vehicle)
        ground.wait(lambda: any(text.startswith("Log: ") for text in ground.texts()), "it is told")
        told = [text for text in ground.texts() if text.startswith("Log: ")]
        assert told == ["Log: File too large"]
        ground.wait(vehicle.turning, "they turn still")
        assert ground.armed
    [log] = logs_of(folder)
    assert log.stat().st_size == 6000
    whole = list(
        map(framed, read_records(log.read_bytes()))
    )  # pymavlink's reader stumbles over half a frame at the end
    assert len(whole) > 50
    assert {1, 255} <= {system for _, system, *_ in whole}


def test_a_folder_that_cannot_be_had_does_not_prevent_driving(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with Reader() as ground, running(tmp_path, "--sim", ground.endpoint, "--tlog", str(tmp_path / "file")) as vehicle:
        vehicle.ready()
        drive(ground, vehicle)
        ground.wait(lambda: "Log: File exists" in ground.texts(), "it is told")
        ground.wait(vehicle.turning, "they turn still")
        assert ground.log_list() == []


def test_a_simulation_that_is_told_no_folder_records_nothing(tmp_path: Path) -> None:
    with Reader() as ground, running(tmp_path, "--sim", ground.endpoint) as vehicle:
        vehicle.ready()
        ground.arm()
        ground.demand = Axes(throttle=0.3)
        ground.wait(vehicle.turning, "the wheels turn")
        assert ground.log_list() == []
    assert not list(tmp_path.rglob("*.tlog"))
