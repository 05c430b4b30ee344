"""When the vehicle records, what it tells of that, and who may remove logs."""

from __future__ import annotations

from dataclasses import dataclass, field

import pytest

from dialects import messages as m
from dialects.enums import Command, Result, Sensor
from link.core import RECORDER
from link.services.ftp.files import MemoryFolder
from link.services.ftp.protocol import FtpOpcode
from tests.vehicle.bench import CYCLE, DRIVER, NEUTRAL, OTHER, Bench
from tests.vehicle.commands.test_files import ask
from vehicle.pace import PERIOD
from vehicle.params import TABLE
from vehicle.storage.logbook import DISARM_PERSIST


@dataclass
class Writer:
    """Stands for the disk: what it was told."""

    told: list[str] = field(default_factory=list)
    problem: str | None = None
    ticks: int = 0
    folder: MemoryFolder = field(
        default_factory=lambda: MemoryFolder({"1.tlog": b"one", "2.tlog": b"two"}, accept=lambda name, data: None)
    )

    def start(self, files: int, megabytes_free: int) -> None:
        self.told.append(f"begin {files} {megabytes_free}")

    def stop(self) -> None:
        self.told.append("end")

    def tick(self, now: float) -> None:
        self.ticks += 1

    def remove_all(self) -> None:
        self.told.append("clear")

    def unix_time(self, name: str) -> int:
        return 1_700_000_000 + int(name[0])


BEGIN = "begin 500 500"


def bench(**params: float) -> tuple[Bench, Writer]:
    writer = Writer()

    class Recorded(Bench):
        recording = writer

    return Recorded(**params), writer


def disarm(rover: Bench) -> None:
    assert rover.command(Command.COMPONENT_ARM_DISARM, 0) is Result.ACCEPTED


def test_a_log_from_arming_until_some_seconds_after_disarming() -> None:
    rover, writer = bench()
    rover.wait(5.0)
    assert writer.told == []
    rover.arm()
    rover.wait(5.0, NEUTRAL)
    assert writer.told == [BEGIN]
    disarm(rover)
    rover.wait(DISARM_PERSIST - 0.1)
    assert writer.told == [BEGIN]
    rover.wait(0.1 + PERIOD + CYCLE)
    assert writer.told == [BEGIN, "end"]
    assert writer.ticks > 20.0 / PERIOD


def test_each_arming_is_a_log_of_its_own() -> None:
    rover, writer = bench()
    for _ in range(3):
        rover.arm()
        rover.wait(1.0, NEUTRAL)
        disarm(rover)
        rover.wait(1.0)
    assert writer.told == [BEGIN] * 3
    rover.wait(DISARM_PERSIST)
    assert writer.told == [BEGIN] * 3 + ["end"]


def test_the_limits_are_parameters() -> None:
    rover, writer = bench(LOG_MAX_FILES=7, LOG_FILE_MB_FREE=20)
    rover.arm()
    rover.wait(0.1)
    assert writer.told == ["begin 7 20"]


def test_log_disarmed_records_from_start_and_each_drive_apart() -> None:
    rover, writer = bench(LOG_DISARMED=1)
    assert writer.told == [BEGIN]
    rover.arm()
    rover.wait(0.5, NEUTRAL)
    disarm(rover)
    rover.wait(2 * DISARM_PERSIST)
    assert writer.told == [BEGIN] * 2


def test_log_disarmed_may_be_switched_while_it_runs() -> None:
    rover, writer = bench()
    rover.say(m.ParamSet(1, 1, b"LOG_DISARMED", 1, 9))
    rover.wait(0.1)
    rover.say(m.ParamSet(1, 1, b"LOG_DISARMED", 0, 9))
    rover.wait(0.1)
    assert writer.told == [BEGIN, "end"]


def test_log_backend_type_0_records_nothing() -> None:
    rover, writer = bench(LOG_BACKEND_TYPE=0, LOG_DISARMED=1)
    writer.problem = "No space left on device"
    rover.drive()
    rover.rover.observe([], rover.now)
    rover.wait(3.0, NEUTRAL)
    assert writer.told == []
    assert not [text for text in rover.texts if text.startswith("Log:")]


def test_recording_fault_is_told_once_a_drive_and_stops_nothing() -> None:
    rover, writer = bench()
    writer.problem = "No space left on device"
    rover.drive()
    for _ in range(10):
        rover.wait(1.0, NEUTRAL)
        rover.rover.observe([], rover.now)
    assert rover.armed
    disarm(rover)
    rover.wait(5.0)
    told = [text for text in rover.texts if text.startswith("Log:")]
    assert told == ["Log: No space left on device"]
    rover.arm()
    rover.wait(5.0, NEUTRAL)
    rover.rover.observe([], rover.now)
    rover.wait(1.0, NEUTRAL)
    assert len([text for text in rover.texts if text.startswith("Log:")]) == 2


def test_a_log_begins_with_all_parameters_for_the_log_alone() -> None:
    rover, _ = bench(SPEED_MAX=3)
    before = len(rover.sent)
    rover.arm()
    rover.wait(1.0, NEUTRAL)
    told = [
        message
        for message, peer in zip(rover.sent[before:], rover.peers[before:], strict=True)
        if isinstance(message, m.ParamValue) and peer == RECORDER
    ]
    assert [message.param_id for message in told] == [parameter.name for parameter in TABLE]
    assert {message.param_id: message.param_value for message in told}["SPEED_MAX"] == 3
    assert len(rover.all(m.ParamValue)) == len(TABLE)


def test_nothing_is_said_to_a_log_that_is_not_there() -> None:
    rover = Bench(LOG_DISARMED=1)
    rover.arm()
    rover.wait(1.0, NEUTRAL)
    assert RECORDER not in rover.peers


@pytest.mark.parametrize(
    ("backend", "problem", "present", "healthy"),
    [(1, None, True, True), (1, "gone", True, False), (0, None, False, False)],
)
def test_sys_status_says_whether_logging_works(backend: int, problem: str | None, present: bool, healthy: bool) -> None:
    rover, writer = bench(LOG_BACKEND_TYPE=backend)
    writer.problem = problem
    rover.wait(3.0)
    told = rover.newest(m.SysStatus)
    assert bool(told.onboard_control_sensors_present & Sensor.LOGGING) is present
    assert bool(told.onboard_control_sensors_health & Sensor.LOGGING) is healthy


# ---- who may remove logs ----


def erase(rover: Bench, system: int = DRIVER, *, introduced: bool = True) -> None:
    rover.say(m.LogErase(1, 1), system, introduced=introduced, named=not introduced)
    rover.wait(0.5)


def take_control(rover: Bench, system: int = DRIVER) -> None:
    assert rover.command(Command.REQUEST_OPERATOR_CONTROL, 1, system=system) is Result.ACCEPTED


def test_the_driver_erases_all_while_disarmed() -> None:
    rover, writer = bench()
    take_control(rover)
    erase(rover)
    assert writer.told == ["clear"]
    assert rover.texts[-1] == f"Logs erased by GCS {DRIVER}"


def test_without_anybody_in_control_no_log_is_removed() -> None:
    """What is removed is lost, so that its sender must have taken control, which all ground stations are told."""
    rover, writer = bench()
    erase(rover, OTHER)
    assert rover.texts[-1] == f"GCS {OTHER}: logs not erased: no GCS is in control, request it first"
    assert ask(rover, FtpOpcode.REMOVE, b"/logs/1.tlog").op == FtpOpcode.NAK
    assert (writer.told, sorted(writer.folder.files)) == ([], ["1.tlog", "2.tlog"])
    take_control(rover, OTHER)
    erase(rover, OTHER)
    assert writer.told == ["clear"]


def test_nobody_erases_while_armed() -> None:
    rover, writer = bench()
    rover.drive()
    erase(rover)
    assert "clear" not in writer.told
    assert f"GCS {DRIVER}: logs not erased: disarm first" in rover.texts


def test_nobody_but_the_driver_erases() -> None:
    rover, writer = bench()
    rover.arm()
    disarm(rover)
    erase(rover, OTHER)
    erase(rover, DRIVER, introduced=False)
    assert "clear" not in writer.told
    assert rover.texts[-2:] == [
        f"GCS {OTHER}: logs not erased: GCS {DRIVER} is in control",
        f"GCS {DRIVER}: logs not erased: its HEARTBEAT is missing",
    ]


@pytest.mark.parametrize("armed", [False, True])
def test_a_log_is_removed_as_a_file_while_disarmed(armed: bool) -> None:
    rover, writer = bench()
    take_control(rover)
    if armed:
        rover.arm()
    answer = ask(rover, FtpOpcode.REMOVE, b"/logs/1.tlog")
    rover.wait(0.5)
    assert answer.op == (FtpOpcode.NAK if armed else FtpOpcode.ACK)
    assert ("1.tlog" in writer.folder.files) is armed
    assert (f"Log 1.tlog removed by GCS {DRIVER}" in rover.texts) is not armed


def test_a_log_that_is_not_there_is_not_reported_as_removed() -> None:
    rover, _ = bench()
    take_control(rover)
    assert ask(rover, FtpOpcode.REMOVE, b"/logs/9.tlog").op == FtpOpcode.NAK
    rover.wait(0.5)
    assert not any("removed" in text for text in rover.texts)


def test_only_the_driver_removes_a_log_as_a_file() -> None:
    rover, writer = bench()
    take_control(rover, OTHER)
    assert ask(rover, FtpOpcode.REMOVE, b"/logs/1.tlog").op == FtpOpcode.NAK
    assert "1.tlog" in writer.folder.files


@pytest.mark.parametrize("op", [FtpOpcode.CREATE, FtpOpcode.OPEN_TO_WRITE])
def test_logs_are_not_written(op: FtpOpcode) -> None:
    assert ask(bench()[0], op, b"/logs/1.tlog").op == FtpOpcode.NAK


def test_the_list_tells_when_a_log_was_begun() -> None:
    rover, _ = bench()
    rover.say(m.LogRequestList(1, 1, 0, 0xFFFF))
    rover.wait(0.1)
    entries = rover.all(m.LogEntry)
    assert [(entry.id, entry.size, entry.time_utc) for entry in entries] == [
        (0, 3, 1_700_000_001),
        (1, 3, 1_700_000_002),
    ]


def test_a_vehicle_with_nowhere_to_record_drives_all_the_same() -> None:
    rover = Bench(LOG_DISARMED=1)
    rover.drive()
    erase(rover)
    assert rover.turning
