"""The doctor with vehicles behind it: our rover, an ArduPilot-like and a PX4-like one."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Autopilot, Command, Result, Sensor
from groundstation.intents.setup import (
    Calibrate,
    ConfirmPosition,
    EndCalibration,
    RebootVehicle,
    RunChecks,
    WatchSticks,
)
from groundstation.intents.watch import Watch
from groundstation.views.doctor import DoctorRequest, DoctorRow, DoctorView, TerminalFacts
from link.runtime.diagnosis import Health
from tests.fakes.rover import FakeArduPilot
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.cockpits import Cockpit
from tests.test_stops import Drive

REQUEST = DoctorRequest(TerminalFacts(0.005))
PREARM = int(Sensor.PREARM)


class Clinic(Cockpit):
    """A cockpit whose Setup screen is shown."""

    def __init__(self, vehicle: FakeVehicle, seconds: float = 6.0) -> None:
        super().__init__(vehicle)
        self.do(Watch((REQUEST,)))
        self.run(seconds)

    @property
    def doctor(self) -> DoctorView:
        """The view now."""
        return _view(self.station.views.build(REQUEST, self.now, self.now))

    def row(self, name: str) -> DoctorRow:
        """A row of the chain."""
        return next(row for row in self.doctor.rows if row.id == name)

    def say(self, text: str, severity: int = 4) -> None:
        """Let the vehicle say something."""
        self.vehicle.send(m.StatusText(severity, text.encode()))
        self.run(0.1)


def _view(view: object) -> DoctorView:
    assert isinstance(view, DoctorView)
    return view


def examined(drive: Drive) -> DoctorView:
    """The view of the real rover now."""
    return _view(drive.station.views.build(REQUEST, drive.world.now, 0))


def sys_status(health: int) -> m.SysStatus:
    return m.SysStatus(PREARM, PREARM, health, 0, 12000, 100, 80, 0, 0, 0, 0, 0, 0)


def test_our_own_rover_is_well() -> None:
    drive = Drive()
    drive.tell(Watch((REQUEST,)))
    drive.run(4.0)
    view = examined(drive)
    assert {row.id for row in view.rows if row.health is Health.UNKNOWN} == {"armed", "fence", "motors"}
    assert not view.faults
    assert drive.station.snapshot(drive.world.now, 0).faults == 0
    assert [motor.name for motor in view.motors] == ["left wheel", "right wheel"]
    assert view.motor_limit == pytest.approx(0.3)
    assert {row.kind for row in view.calibrations if row.state != "cannot"} == {"gyro"}


def test_our_rover_says_what_keeps_it_from_arming() -> None:
    drive = Drive()
    drive.params.set("BATT_LOW_VOLT", 9)
    drive.tell(Watch((REQUEST,)))
    drive.run(4.0)
    drive.tell(RunChecks(1, 1))
    drive.run(2.0)
    view = examined(drive)
    assert [(text.text, text.advice) for text in view.texts] == [
        ("BATT_CRT_VOLT is above BATT_LOW_VOLT", "set BATT_CRT_VOLT below BATT_LOW_VOLT")
    ]
    assert [row.id for row in view.faults] == ["pre_arm"]
    assert drive.station.snapshot(drive.world.now, 0).faults == 1
    drive.params.set("BATT_LOW_VOLT", 10.5)
    drive.run(2.5)
    view = examined(drive)
    assert not view.texts
    assert not view.faults


def test_ardupilots_settings_and_reasons() -> None:
    clinic = Clinic(FakeArduPilot())
    stop = clinic.row("stop_bound")
    assert stop.health is Health.WARNING
    assert stop.fix is not None
    assert (stop.fix.name, stop.fix.before, stop.fix.value) == ("RC_OVERRIDE_TIME", 3.0, 0.5)
    assert clinic.row("gcs_failsafe").fix is not None
    clinic.say("PreArm: Compass not calibrated")
    clinic.run(1.2)
    row = clinic.row("pre_arm")
    assert (row.health, row.evidence, row.advice) == (
        Health.FAULT, "Compass not calibrated", "calibrate the compass, outdoors",
    )  # fmt: skip
    clinic.run(36.0)
    assert clinic.row("pre_arm").health is Health.UNKNOWN, "ArduPilot repeats every 30 s what still holds"


def test_an_ardupilot_that_obeys_another_station() -> None:
    vehicle = FakeArduPilot(station=250)
    vehicle.params["MAV_GCS_SYSID"] = 250.0
    clinic = Clinic(vehicle)
    assert clinic.row("our_id").health is Health.FAULT
    view = clinic.station.views.build(DoctorRequest(station=250), clinic.now, clinic.now)
    assert next(row for row in _view(view).rows if row.id == "our_id").health is Health.OK


def test_px4_reports_the_bit_and_its_own_texts() -> None:
    vehicle = FakeVehicle(autopilot=Autopilot.PX4)
    vehicle.params.replace({"COM_RC_LOSS_T": 0.5, "NAV_RCL_ACT": 0.0})
    clinic = Clinic(vehicle)
    vehicle.send(sys_status(0))
    clinic.say("Preflight Fail: No manual control input")
    clinic.run(1.2)
    assert clinic.row("pre_arm").advice == "arm from Drive: it sends MANUAL_CONTROL first"
    vehicle.send(sys_status(PREARM))
    clinic.run(1.2)
    assert clinic.row("pre_arm").health is Health.OK
    assert [motor.name for motor in clinic.doctor.motors] == ["motor 1", "motor 2", "servo 1"]


def test_checks_forget_older_reasons_and_say_when_they_ran() -> None:
    clinic = Clinic(FakeArduPilot())
    clinic.say("PreArm: GPS 1: Bad fix")
    clinic.run(3.0)
    clinic.do(RunChecks(5, 1))
    clinic.run(1.0)
    assert clinic.vehicle.commands(Command.RUN_PREARM_CHECKS)
    assert clinic.doctor.texts == ()
    checked = clinic.doctor.checked
    assert checked is not None
    assert (checked.number, checked.state) == (5, "accepted")
    assert clinic.doctor.checked_ago == 0.0


@pytest.mark.parametrize(("answer", "state"), [(Result.UNSUPPORTED, "refused"), (None, "no answer")])
def test_a_vehicle_that_cannot_run_the_checks(answer: Result | None, state: str) -> None:
    clinic = Clinic(FakeArduPilot())
    if answer is None:
        clinic.vehicle.silent_on.add(Command.RUN_PREARM_CHECKS)
    else:
        clinic.vehicle.answers[Command.RUN_PREARM_CHECKS] = answer
    clinic.do(RunChecks(5, 1))
    clinic.run(4.0)
    checked = clinic.doctor.checked
    assert checked is not None
    assert checked.state == state


def test_reboot_is_one_command_to_the_vehicle_that_was_seen() -> None:
    clinic = Clinic(FakeArduPilot())
    clinic.do(RebootVehicle(1, 2), RebootVehicle(2, 1))
    clinic.run(1.0)
    assert [command.param1 for command in clinic.vehicle.commands(Command.PREFLIGHT_REBOOT_SHUTDOWN)] == [1.0]


def test_the_parameters_are_read_while_the_screen_is_shown_only() -> None:
    vehicle = FakeVehicle()
    cockpit = Cockpit(vehicle)
    cockpit.run(5.0)
    assert not vehicle.all(m.ParamRequestRead)
    cockpit.do(Watch((REQUEST,)))
    cockpit.run(1.0)
    assert {message.param_id for _, message in vehicle.all(m.ParamRequestRead)} >= {"FS_GCS_ENABLE", "MOT_TEST_MAX"}


# ---- calibration ----


def test_the_accelerometers_in_six_positions() -> None:
    clinic = Clinic(FakeArduPilot())
    clinic.do(Calibrate(1, 1, "accel"))
    clinic.run(0.5)
    assert clinic.vehicle.commands(Command.PREFLIGHT_CALIBRATION)[0].param5 == 1
    clinic.do(ConfirmPosition(1))
    assert not clinic.vehicle.commands(Command.ACCELCAL_VEHICLE_POS), "it has not asked yet"
    for position, words in enumerate(("level", "left", "right", "nose down", "nose up", "back"), 1):
        clinic.vehicle.send(m.CommandLong(255, 190, Command.ACCELCAL_VEHICLE_POS, 0, position, 0, 0, 0, 0, 0, 0))
        clinic.run(0.1)
        assert clinic.doctor.waits_for_position
        assert words in clinic.doctor.calibration
        clinic.do(ConfirmPosition(1), ConfirmPosition(1))
        clinic.run(0.1)
        sent = clinic.vehicle.commands(Command.ACCELCAL_VEHICLE_POS)
        assert [command.param1 for command in sent] == list(range(1, position + 1))
    clinic.vehicle.send(m.CommandLong(255, 190, Command.ACCELCAL_VEHICLE_POS, 0, 16777215, 0, 0, 0, 0, 0, 0))
    clinic.run(0.1)
    assert clinic.doctor.calibration == "accelerometers: done"


def measures(clinic: Clinic, compass: int, percent: int, status: int = 2, attempt: int = 1) -> None:
    """Let a compass of two report its progress."""
    clinic.vehicle.send(m.MagCalProgress(compass, 3, status, attempt, percent, [0] * 10, 0.0, 0.0, 1.0))
    clinic.run(0.1)


def reports(clinic: Clinic, compass: int, status: int, fitness: float = 8.2, mask: int = 3) -> None:
    """Let a compass report how it ended."""
    clinic.vehicle.send(m.MagCalReport(compass, mask, status, 0, fitness, 1, 2, 3, 0, 0, 0, 0, 0, 0))
    clinic.run(0.1)


def compass_is_done(clinic: Clinic) -> bool:
    return next(row for row in clinic.doctor.calibrations if row.kind == "compass").health is Health.OK


def test_the_compasses_with_their_progress_and_fit() -> None:
    clinic = Clinic(FakeArduPilot())
    clinic.do(Calibrate(1, 1, "compass"))
    clinic.run(0.5)
    assert clinic.vehicle.commands(Command.DO_START_MAG_CAL)[0].param3 == 0, "not saved by itself"
    requested = {command.param1 for command in clinic.vehicle.commands(Command.SET_MESSAGE_INTERVAL)}
    assert requested >= {m.MagCalProgress.id, m.MagCalReport.id}
    measures(clinic, 0, 40)
    assert clinic.doctor.calibration_share == 0.0, "the second one has not begun"
    measures(clinic, 1, 30, attempt=2)
    assert clinic.doctor.calibration_share == pytest.approx(0.3)
    assert "compass 1 40 %, compass 2 30 % (attempt 2)" in clinic.doctor.calibration
    reports(clinic, 0, 4)
    assert "compass 1 fit 8.2, compass 2 30 % (attempt 2)" in clinic.doctor.calibration
    assert not clinic.doctor.compass_ready
    reports(clinic, 1, 4, 11.0)
    assert clinic.doctor.calibration == "compass 1 fit 8.2, compass 2 fit 11.0: W writes it, x cancels"
    assert clinic.doctor.compass_ready
    assert clinic.doctor.calibration_share is None
    assert not clinic.vehicle.commands(Command.DO_ACCEPT_MAG_CAL)
    assert not compass_is_done(clinic)
    clinic.do(EndCalibration(2, 1, accept=True))
    clinic.run(0.5)
    assert len(clinic.vehicle.commands(Command.DO_ACCEPT_MAG_CAL)) == 1
    assert compass_is_done(clinic)
    assert clinic.doctor.calibration == "compass: written; restart the vehicle"
    assert not clinic.doctor.compass_ready


def test_a_refused_result_of_the_compass_is_kept() -> None:
    clinic = Clinic(FakeArduPilot())
    clinic.vehicle.answers[Command.DO_ACCEPT_MAG_CAL] = Result.FAILED
    clinic.do(Calibrate(1, 1, "compass"))
    clinic.run(0.5)
    reports(clinic, 0, 4, mask=1)
    clinic.do(EndCalibration(2, 1, accept=True))
    clinic.run(2.0)
    assert [line.state for line in clinic.doctor.requests if "write" in line.what] == ["refused"]
    assert clinic.doctor.compass_ready
    assert not compass_is_done(clinic)


def test_a_cancelled_calibration_of_the_compass() -> None:
    clinic = Clinic(FakeArduPilot())
    clinic.do(Calibrate(1, 1, "compass"))
    measures(clinic, 0, 40)
    clinic.do(EndCalibration(2, 1))
    measures(clinic, 0, 41)  # it was on the way
    clinic.run(0.5)
    assert len(clinic.vehicle.commands(Command.DO_CANCEL_MAG_CAL)) == 1
    assert clinic.doctor.calibration == ""
    assert clinic.doctor.calibration_share is None


@pytest.mark.parametrize(("status", "words"), [(5, "failed"), (7, "the radius"), (10, "residuals"), (200, "failed")])
def test_a_compass_that_fails(status: int, words: str) -> None:
    clinic = Clinic(FakeArduPilot(), 2.0)
    clinic.do(Calibrate(1, 1, "compass"))
    reports(clinic, 0, 4)
    reports(clinic, 1, status, float("nan"))
    assert words in clinic.doctor.calibration
    assert clinic.doctor.calibration.endswith(": x cancels")
    assert not clinic.doctor.compass_ready


STICK_PARAMS = {f"RC{channel}_{name}": value for channel in (1, 2, 3)
                for name, value in (("MIN", 1100.0), ("TRIM", 1500.0), ("MAX", 1900.0), ("REVERSED", 0.0))}  # fmt: skip


def move_sticks(clinic: Clinic, *pulses: dict[int, int]) -> None:
    """Hold the sticks in one place after the other, for 0.4 s each."""
    vehicle = clinic.vehicle
    assert isinstance(vehicle, FakeArduPilot)
    for places in pulses:
        vehicle.sticks |= places
        clinic.run(0.4)


def test_the_ends_and_centres_of_the_sticks_become_changes() -> None:
    vehicle = FakeArduPilot()
    vehicle.params |= STICK_PARAMS
    clinic = Clinic(vehicle)
    vehicle.sticks = {1: 1500, 2: 1500, 3: 1500, 4: 65535, 5: 0}
    assert clinic.doctor.sticks is None
    clinic.do(WatchSticks(1))
    clinic.run(0.6)
    move_sticks(clinic, {1: 1102, 2: 1450}, {1: 1898, 2: 1550}, {3: 1100, 1: 1504}, {3: 1900}, {3: 1500, 2: 1500})
    view = clinic.doctor
    assert view.sticks is not None
    assert [(row.channel, row.low, row.high, row.now, row.moved) for row in view.sticks] == [
        (1, 1102, 1898, 1504, True), (2, 1450, 1550, 1500, False), (3, 1100, 1900, 1500, True),
    ]  # fmt: skip
    assert "moved: 1, 3" in view.calibration
    clinic.run(2.0)
    assert not clinic.doctor.sticks_unread
    assert [(each.name, each.before, each.value) for each in clinic.doctor.stick_changes] == [
        ("RC1_MIN", 1100.0, 1102.0), ("RC1_TRIM", 1500.0, 1504.0), ("RC1_MAX", 1900.0, 1898.0),
    ]  # fmt: skip
    clinic.do(WatchSticks(1, on=False))
    assert clinic.doctor.sticks is None
    clinic.run(0.5)
    assert not vehicle.all(m.ParamSet), "nothing is written"
    rates = [each.param2 for each in vehicle.commands(Command.SET_MESSAGE_INTERVAL) if each.param1 == m.RcChannels.id]
    assert rates[-2:] == [100_000, 500_000]


def test_no_sticks_of_an_armed_vehicle() -> None:
    vehicle = FakeArduPilot()
    clinic = Clinic(vehicle)
    vehicle.armed = True
    clinic.run(2.0)
    clinic.do(WatchSticks(1))
    assert clinic.doctor.sticks is None
    vehicle.armed = False
    clinic.run(2.0)
    clinic.do(WatchSticks(1))
    assert clinic.doctor.sticks is not None
    vehicle.armed = True
    clinic.run(2.0)
    assert clinic.doctor.sticks is None
    assert clinic.doctor.calibration == "RC sticks: ended, the vehicle is armed"


def test_px4_says_in_texts_what_to_do() -> None:
    clinic = Clinic(FakeVehicle(autopilot=Autopilot.PX4))
    clinic.do(Calibrate(1, 1, "compass-px4"))
    clinic.run(0.5)
    assert clinic.vehicle.commands(Command.PREFLIGHT_CALIBRATION)[0].param2 == 1
    clinic.say("[cal] progress <40>", 6)
    assert clinic.doctor.calibration == "progress <40>"


def test_px4_has_not_calibrated_when_it_has_accepted() -> None:
    clinic = Clinic(FakeVehicle(autopilot=Autopilot.PX4))
    clinic.do(Calibrate(1, 1, "gyro"))
    clinic.run(2.0)
    gyro = next(row for row in clinic.doctor.calibrations if row.kind == "gyro")
    assert gyro.state == ""
    clinic.say("[cal] calibration done: gyro", 6)
    gyro = next(row for row in clinic.doctor.calibrations if row.kind == "gyro")
    assert gyro.state == "done"


def test_what_is_done_when_it_is_accepted() -> None:
    clinic = Clinic(FakeArduPilot())
    clinic.do(Calibrate(1, 1, "gyro"))
    clinic.run(0.5)
    done = {row.kind for row in clinic.doctor.calibrations if row.health is Health.OK}
    assert done == {"gyro"}


@pytest.mark.parametrize("position", [0, 7, -1, float("nan"), float("inf"), 1e30])
def test_positions_that_do_not_exist(position: float) -> None:
    clinic = Clinic(FakeArduPilot(), 2.0)
    clinic.vehicle.send(m.CommandLong(255, 190, Command.ACCELCAL_VEHICLE_POS, 0, position, 0, 0, 0, 0, 0, 0))
    clinic.run(0.1)
    assert not clinic.doctor.waits_for_position
