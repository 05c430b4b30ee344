"""The chain: each row judges the known state; and what a row proposes exists."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest

from dialects.enums import Autopilot, Sensor
from groundstation.actions import ACTIONS
from groundstation.doctor.chain import CHAIN, count_faults, examine
from groundstation.doctor.facts import DoctorFacts, PathFact, PreArmText, SensorBits, SettingFact
from groundstation.snapshot import LinkView, OperatorView, OutputView, VehicleView
from groundstation.snapshot.drive import StopBound
from groundstation.vehicles.stops.settings_check import SETTINGS
from groundstation.vehicles.stops.stop_bounds import find_rules, stop_bounds
from groundstation.vehicles.stops.stop_rules import StopFacts
from groundstation.views.doctor import DoctorRow, ParamFix, TerminalFacts
from link.runtime.diagnosis import Health
from tests.rows import each_row

OK, WARNING, FAULT, UNKNOWN = Health.OK, Health.WARNING, Health.FAULT, Health.UNKNOWN
FENCE = int(Sensor.GEOFENCE)
MOTORS = int(Sensor.MOTOR_OUTPUTS)
LINK = LinkView(name="udpin:127.0.0.1:14550", loss=0.003, round_trip=0.012, frames=500, systems=(1,))


OURS = {"MAN_TIMEOUT": 0.45, "FS_TIMEOUT": 1.5, "FS_GCS_ENABLE": 1.0, "FS_GCS_TIMEOUT": 5.0}
ARDUPILOT = {"RC_OVERRIDE_TIME": 0.5, "FS_THR_ENABLE": 1.0, "FS_TIMEOUT": 1.5, "FS_ACTION": 2.0,
             "FS_GCS_ENABLE": 1.0, "FS_GCS_TIMEOUT": 5.0}  # fmt: skip
PX4 = {"COM_RC_IN_MODE": 1.0, "COM_RC_LOSS_T": 0.5, "NAV_RCL_ACT": 6.0, "COM_DL_LOSS_T": 10.0, "NAV_DLL_ACT": 1.0}


def stops(params: Mapping[str, float], autopilot: int = 0, *, drives_itself: bool = False) -> tuple[StopBound, ...]:
    """What the Drive screen shows with these parameters."""
    rules = find_rules(autopilot, own_dialect=autopilot == 0)
    return stop_bounds(rules, StopFacts(params=params, drives_itself=drives_itself))


def foreign(autopilot: int, params: Mapping[str, float]) -> DoctorFacts:
    """A vehicle of another autopilot with these parameters, which its settings check has read."""
    checks = SETTINGS[autopilot].checks
    settings = tuple(
        SettingFact(name, value, checks[name](value, 255) or "") for name, value in params.items() if name in checks
    )
    view = vehicle(autopilot=autopilot, stops=stops(params, autopilot))
    return facts(view, rover_dialect=False, settings=settings, params=params)


def vehicle(**changes: Any) -> VehicleView:
    values: dict[str, Any] = {
        "system": 1, "name": "Rover 1", "autopilot": 0, "mode": "MANUAL", "armed": False, "status": 3, "alive": True,
        "silence": 0.1, "driver": 0, "prearm": True, "battery_voltage": 12.1, "battery_remaining": 0.76,
        "stops": stops(OURS),
    }  # fmt: skip
    return VehicleView(**(values | changes))


def link(**changes: Any) -> tuple[LinkView, ...]:
    values = {name: getattr(LINK, name) for name in LINK.__struct_fields__}
    return (LinkView(**(values | changes)),)


def facts(view: VehicleView | None = None, **changes: Any) -> DoctorFacts:
    values: dict[str, Any] = {
        "system": 255, "vehicle": view or vehicle(), "links": (LINK,), "endpoints": ("udpin:127.0.0.1:14550",),
        "terminal": TerminalFacts(0.005), "rover_dialect": True,
        "operator": OperatorView(reports_releases=True), "params": {"FS_GCS_ENABLE": 1.0, "FS_GCS_TIMEOUT": 5.0},
    }  # fmt: skip
    return DoctorFacts(**(values | changes))


def row(name: str, known: DoctorFacts) -> DoctorRow:
    return next(each for each in examine(known) if each.id == name)


def setting(name: str, value: float, warning: str = "") -> tuple[SettingFact, ...]:
    return (SettingFact(name, value, warning),)


def bits(sensor: int, *, enabled: bool = True, healthy: bool = True) -> SensorBits:
    return SensorBits(sensor, sensor if enabled else 0, sensor if healthy else 0)


NOBODY = DoctorFacts(system=255)

CASES: list[tuple[str, DoctorFacts, Health, str]] = [
    ("keys", facts(), OK, "reports key releases, ping 5 ms"),
    ("keys", facts(operator=OperatorView(stop_bound=0.75)), OK, "timers end a key press, 0.75 s at most"),
    ("keys", facts(operator=OperatorView(stop_bound=float("inf"))), OK, "until the next key"),
    ("keys", facts(terminal=TerminalFacts(0.4)), WARNING, "answers after 400 ms"),
    ("keys", facts(terminal=TerminalFacts(silent=True)), FAULT, "does not answer"),
    ("keys", facts(terminal=None), UNKNOWN, "no screen"),
    ("station", facts(), OK, "runs as system 255"),
    ("station", facts(operator=OperatorView(sending=True, rate=20.0)), OK, "sends 20 demands/s"),
    ("station", facts(operator=OperatorView(gate_reason="screen was frozen")), WARNING, "screen was frozen"),
    ("link", facts(), OK, "round trip 12 ms, 0.3% lost, 0 bad"),
    ("link", facts(links=link(loss=0.1)), WARNING, "10.0% lost"),
    ("link", facts(links=link(loss=0.4)), FAULT, "40.0% lost"),
    ("link", facts(links=link(round_trip=0.3)), WARNING, "300 ms"),
    ("link", facts(links=link(round_trip=0.6)), FAULT, "600 ms"),
    ("link", facts(links=link(crc_errors=50)), WARNING, "50 bad"),
    ("link", facts(links=link(round_trip=None)), UNKNOWN, "not answered"),
    ("link", facts(links=link(problem="no room")), WARNING, "no room"),
    ("link", facts(links=link(frames=0)), UNKNOWN, "not measured yet"),
    ("link", DoctorFacts(system=255, endpoints=("udpin:1",)), FAULT, "nothing heard on udpin:1"),
    ("link", DoctorFacts(system=255, links=link(frames=0, bytes_received=9)), FAULT, "bytes arrive, but no MAVLink"),
    ("link", DoctorFacts(system=255, links=link(frames=0, problem="no such device")), FAULT, "no such device"),
    ("vehicle", facts(firmware="4.7.0"), OK, "Rover 1, firmware 4.7.0"),
    ("vehicle", facts(vehicle(alive=False, silence=7.0, link_loss_action="it stops by itself")), FAULT,
     "lost for 7 s: it stops by itself"),
    ("vehicle", NOBODY, UNKNOWN, "no HEARTBEAT"),
    ("dialect", facts(), OK, "rover.xml"),
    ("dialect", facts(rover_dialect=False, unknown_share=0.26), OK, "26% of the frames"),
    ("dialect", facts(mismatched=("HEARTBEAT",)), WARNING, "HEARTBEAT"),
    ("our_id", facts(), OK, "255, nobody else"),
    ("our_id", facts(id_conflict="ground station 255/1 uses our system id: start with --system 254"), FAULT, "255/1"),
    ("our_id", facts(own_id=True), FAULT, "another program"),
    ("our_id", facts(settings=setting("MAV_GCS_SYSID", 250.0)), FAULT, "obeys ground station 250 only"),
    ("our_id", facts(settings=setting("SYSID_MYGCS", 300.0)), FAULT, "obeys ground station 44 only"),
    ("our_id", facts(settings=setting("MAV_GCS_SYSID", 255.0)), OK, "255"),
    ("our_id", facts(params={"MAV_GCS_SYSID": 0.0}), OK, "255"),
    ("our_id", facts(signs=True), WARNING, "signs"),
    ("our_id", facts(verified=True), OK, "signed both ways"),
    ("control", facts(), OK, "nobody: arming takes it"),
    ("control", facts(vehicle(driver=None)), OK, "not managed"),
    ("control", facts(vehicle(in_control=True, armed=True)), OK, "this station"),
    ("control", facts(vehicle(driver=250)), FAULT, "ground station 250"),
    ("control", facts(vehicle(driver=250, control_wait=4.0)), FAULT, "may answer for 4 s"),
    ("control", facts(vehicle(driver=255)), OK, "ground station 255"),
    ("control", facts(vehicle(driver=255, duplicate_gcs=True)), FAULT, "another program with our id 255"),
    ("control", facts(vehicle(armed=True, driver=0)), FAULT, "armed, and not in control"),
    ("control", facts(vehicle(armed=True, driver=None), terminal=None), UNKNOWN, "does not report who is in control"),
    ("control", facts(vehicle(armed=True, driver=None)), FAULT, "armed, and not in control"),
    ("control", facts(clash=True), FAULT, "two programs"),
    ("pre_arm", facts(), OK, "passed"),
    ("pre_arm", facts(vehicle(armed=True, prearm=False)), OK, "armed"),
    ("pre_arm", facts(vehicle(prearm=None)), UNKNOWN, "not reported"),
    ("pre_arm", facts(vehicle(prearm=None, autopilot=12, status=0)), WARNING, "do not pass now: HEARTBEAT says UNINIT"),
    ("pre_arm", facts(vehicle(prearm=None, autopilot=12, status=3)), OK, "passed: HEARTBEAT says STANDBY"),
    ("pre_arm", facts(vehicle(prearm=False)), FAULT, "has not said why"),
    ("pre_arm", facts(vehicle(prearm=False), texts=(PreArmText("Compass not calibrated", 1.0),) * 2), FAULT,
     "Compass not calibrated (+1)"),
    ("mode", facts(), OK, "MANUAL: keys drive"),
    ("mode", facts(vehicle(mode="HOLD", drivable=False)), WARNING, "arming changes to MANUAL"),
    ("mode", facts(vehicle(mode="HOLD", drivable=False, armed=True)), FAULT, "the sticks do nothing"),
    ("mode", facts(vehicle(mode="AUTO", drivable=False, armed=True)), FAULT, "drives itself"),
    ("armed", facts(), UNKNOWN, "no"),
    ("armed", facts(vehicle(armed=True)), OK, "armed"),
    ("armed", facts(vehicle(emergency_stop=True)), FAULT, "EMERGENCY STOP"),
    ("armed", facts(vehicle(refusal="arm failed: PreArm: battery low")), FAULT, "battery low"),
    ("stop_bound", facts(), OK, "neutral 0.45 s (MAN_TIMEOUT), HOLD 1.95 s (FS_TIMEOUT) after the last demand"),
    ("stop_bound", facts(settings=setting("RC_OVERRIDE_TIME", 3.0, "RC_OVERRIDE_TIME 3: drives on; set it to 0.5")),
     WARNING, "RC_OVERRIDE_TIME 3: drives on"),
    ("stop_bound", facts(settings=setting("FS_THR_ENABLE", 0.0, "FS_THR_ENABLE 0: never stops; set it to 1")), FAULT,
     "never stops"),
    ("stop_bound", facts(rover_dialect=False, unread=("RC_OVERRIDE_TIME",)), WARNING, "could not read"),
    ("stop_bound", foreign(Autopilot.ARDUPILOT, ARDUPILOT), OK,
     "RC input 0.5 s (RC_OVERRIDE_TIME), neutral 0.5 s later without RC (FS_THR_ENABLE), HOLD 2 s later without RC"),
    ("stop_bound", foreign(Autopilot.ARDUPILOT, ARDUPILOT | {"RC_OVERRIDE_TIME": -1.0}), FAULT, "never stops"),
    ("stop_bound", foreign(Autopilot.ARDUPILOT, ARDUPILOT | {"FS_THR_ENABLE": 0.0}), FAULT, "never stops"),
    ("stop_bound", foreign(Autopilot.ARDUPILOT, ARDUPILOT | {"FS_ACTION": 0.0}), WARNING, "without RC (FS_THR_ENABLE), "
     "then nothing"),
    ("stop_bound", foreign(Autopilot.PX4, PX4), OK, "disarm 0.5 s (COM_RC_LOSS_T) after the last demand"),
    ("stop_bound", foreign(Autopilot.PX4, PX4 | {"NAV_RCL_ACT": 0.0}), FAULT, "never stops"),
    ("stop_bound", facts(vehicle(stops=stops({}))), UNKNOWN, "not known yet"),
    ("stop_bound", facts(vehicle(stops=stops({}, 99)), rover_dialect=False), UNKNOWN, "not known yet"),
    ("gcs_failsafe", facts(), OK, "HOLD 5 s after"),
    ("gcs_failsafe", facts(vehicle(stops=stops(OURS | {"FS_GCS_ENABLE": 2.0})), params={"FS_GCS_ENABLE": 2.0}), OK,
     "except in AUTO"),
    ("gcs_failsafe", facts(vehicle(stops=stops(OURS | {"FS_GCS_ENABLE": 2.0}, drives_itself=True)),
                           params={"FS_GCS_ENABLE": 2.0}), WARNING, "AUTO goes on"),
    ("gcs_failsafe", facts(vehicle(stops=stops(OURS | {"FS_GCS_ENABLE": 0.0})), params={"FS_GCS_ENABLE": 0.0}), WARNING,
     "no failsafe"),
    ("gcs_failsafe", foreign(Autopilot.ARDUPILOT, ARDUPILOT), OK, "HOLD 6.5 s after"),
    ("gcs_failsafe", foreign(Autopilot.ARDUPILOT, ARDUPILOT | {"FS_ACTION": 0.0}), WARNING, "action is switched off"),
    ("gcs_failsafe", foreign(Autopilot.ARDUPILOT, ARDUPILOT | {"MAV_GCS_SYSID": 254.0}), OK, "HOLD 6.5 s after"),
    ("our_id", foreign(Autopilot.ARDUPILOT, ARDUPILOT | {"MAV_GCS_SYSID": 254.0}), FAULT, "obeys ground station 254"),
    ("gcs_failsafe", foreign(Autopilot.PX4, PX4), OK, "HOLD 10 s after"),
    ("stop_bound", foreign(Autopilot.PX4, PX4 | {"NAV_RCL_ACT": 1.0}), WARNING, "holds a place, and may drive for it"),
    ("mode", facts(vehicle(undriven="keys do not drive a copter")), FAULT, "keys do not drive a copter"),
    ("armed", facts(vehicle(undriven="keys do not drive a copter", armed=True)), UNKNOWN, "armed, not from here"),
    ("stop_bound", facts(vehicle(undriven="keys do not drive a copter")), UNKNOWN, "not driven from here"),
    ("gcs_failsafe", facts(vehicle(stops=stops({})), params={}), UNKNOWN, "not known yet"),
    ("gcs_failsafe", facts(settings=setting("NAV_DLL_ACT", 0.0, "NAV_DLL_ACT 0: no failsafe; set it to 1")), WARNING,
     "NAV_DLL_ACT 0"),
    ("failsafes", facts(), OK, "none acts"),
    ("failsafes", facts(vehicle(failsafes=("gcs loss", "estop"))), FAULT, "active: gcs loss"),
    ("failsafes", facts(vehicle(status=5)), FAULT, "reports a failsafe"),
    ("dialect", facts(version_1=True), WARNING, "MAVLink 1: it is answered in that version"),
    ("fence", facts(), UNKNOWN, "none is loaded"),
    ("fence", facts(sensors=bits(FENCE)), OK, "inside"),
    ("fence", facts(sensors=bits(FENCE, enabled=False)), WARNING, "loaded, but off"),
    ("fence", facts(sensors=bits(FENCE, enabled=False), rover_dialect=False), UNKNOWN, "off; `fence show` says"),
    ("fence", facts(sensors=bits(FENCE, healthy=False)), FAULT, "breached"),
    ("fence", facts(vehicle(limits=("fence",))), FAULT, "breached"),
    ("battery", facts(), OK, "12.1 V, 76%"),
    ("battery", facts(params={"BATT_LOW_VOLT": 12.5}), WARNING, "below BATT_LOW_VOLT 12.5"),
    ("battery", facts(vehicle(battery_remaining=0.1)), WARNING, "10%"),
    ("battery", facts(vehicle(battery_voltage=None)), UNKNOWN, "not reported"),
    ("motors", facts(vehicle(outputs=(OutputView(name="left wheel", value=0.0),))), UNKNOWN, "left wheel: not tested"),
    ("motors", facts(motors_tested=frozenset({1, 2})), OK, "tested in this session: 1, 2"),
    ("motors", facts(sensors=bits(MOTORS, healthy=False)), FAULT, "motor driver has failed"),
    ("motors", facts(vehicle(armed=True, outputs=(OutputView(name="left wheel", value=0.5),))), OK, "left wheel +50%"),
]  # fmt: skip


@each_row(("name", "known", "health", "words"), CASES, ids=lambda each: "" if isinstance(each, DoctorFacts) else each)
def test_a_row_judges(name: str, known: DoctorFacts, health: Health, words: str) -> None:
    found = row(name, known)
    assert words in found.evidence
    assert found.health is health
    assert found.advice or health not in (WARNING, FAULT) or name == "link", "a fault says what to do"


def test_every_row_has_cases_and_waits_if_it_needs_a_vehicle() -> None:
    assert {each.id for each in CHAIN} == {case[0] for case in CASES}
    waiting = {each.id: each.health for each in examine(NOBODY)}
    assert [name for name, health in waiting.items() if health is FAULT] == ["link"]
    assert count_faults(examine(NOBODY)) == 1
    assert count_faults(examine(facts())) == 0


def test_what_a_row_does_exists() -> None:
    own = {"setup.checks", "setup.motors"}
    actions = {each.action for case in CASES for each in examine(case[1]) if each.action}
    assert actions - own <= ACTIONS.keys()
    assert own < actions


def test_a_dangerous_setting_is_proposed_as_a_change() -> None:
    known = facts(settings=setting("RC_OVERRIDE_TIME", 3.0, "RC_OVERRIDE_TIME 3: drives on for 3 s; set it to 0.5"))
    assert row("stop_bound", known).fix == ParamFix("RC_OVERRIDE_TIME", 3.0, 0.5)
    off = facts(vehicle(stops=stops(OURS | {"FS_GCS_ENABLE": 0.0})), params={"FS_GCS_ENABLE": 0.0})
    assert row("gcs_failsafe", off).fix == ParamFix("FS_GCS_ENABLE", 0.0, 1.0)


@pytest.mark.parametrize(("autopilot", "params"), [(Autopilot.ARDUPILOT, ARDUPILOT), (Autopilot.PX4, PX4)])
def test_doctor_and_drive_agree_on_every_setting(autopilot: int, params: dict[str, float]) -> None:
    """With each parameter off, negative, large and not known: what never stops on Drive is not well here."""
    for name in params:
        for value in (0.0, -1.0, 2.0, 3.0, 5.0, None):
            changed = {**params, name: value}
            known = {each: number for each, number in changed.items() if number is not None}
            judged = foreign(autopilot, known)
            assert judged.vehicle is not None
            for stop in judged.vehicle.stops:
                found = row("gcs_failsafe" if stop.name == "no station" else "stop_bound", judged)
                case = (name, value, stop, found)
                assert not (stop.never and found.health in (OK, UNKNOWN)), case
                if found.health is OK and stop.bound is not None:
                    assert f"{stop.does} {stop.bound:g} s" in found.evidence, case


def test_two_links_of_one_network_are_one_path() -> None:
    wifi, same = PathFact("udpin:0.0.0.0:14550", "10.0.0.2", "10.0.0.7"), PathFact("udpin:*:1", "10.0.0.2", "10.0.0.7")
    found = row("link", facts(paths=(wifi, same)))
    assert found.health is WARNING
    assert "both paths (udpin:0.0.0.0:14550 and udpin:*:1) lead to 10.0.0.7: one cut ends both" in found.evidence
    other = PathFact("tcpout:lte:1", "10.0.0.2", "198.51.100.9")  # another host, by the same interface
    assert "leave by 10.0.0.2" in row("link", facts(paths=(wifi, other))).evidence
    apart = PathFact("tcpout:lte:1", "192.0.2.7", "198.51.100.9")
    assert row("link", facts(paths=(wifi, apart))).health is OK
    here = tuple(PathFact(f"udpin:{port}", "127.0.0.1", "127.0.0.1") for port in (1, 2))
    assert "what is behind is not known" in row("link", facts(paths=here)).evidence
    assert row("link", facts(paths=here)).health is OK
    lossy = row("link", facts(paths=(wifi, same), links=link(loss=0.5)))
    assert lossy.health is FAULT  # the worse comes first


def test_of_several_links_the_one_that_counts_is_judged() -> None:
    late = LinkView(name="late", loss=0.0, round_trip=2.0, frames=9, systems=(1,))
    assert "12 ms" in row("link", facts(links=(late, *link(counts=True)))).evidence
