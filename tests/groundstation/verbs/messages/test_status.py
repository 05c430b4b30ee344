"""`mavhelm status`, `vehicles` and `links` with vehicles as ArduPilot behaves, on real sockets."""

from __future__ import annotations

import json
from typing import Any

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mav

from dialects import messages as m
from dialects.enums import Command, Result
from groundstation.verbs.common.exit_codes import ExitCode
from groundstation.verbs.common.output import Output
from groundstation.verbs.messages.status import _failsafes, _link_cells, _speed
from groundstation.verbs.messages.status_changes import ChangePrinter
from link.core import LinkReport, SourceCount
from tests.fakes.lone_verb import LoneVerb
from tests.fakes.services import foreign_vehicle
from tests.groundstation.vehicles.state.test_vehicle_state import heartbeat, received
from tests.groundstation.verbs.verb_runs import run_verb
from tests.ports import free_port

Capture = pytest.CaptureFixture[str]
PREARM, FENCE = 0x10000000, 0x100000


def test_status_requests_what_the_vehicle_does_not_send(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.armed, vehicle.mode = True, 15
        vehicle.telemetry = {
            1: mav.MAVLink_sys_status_message(PREARM, PREARM, 0, 0, 11800, -1, 73, 0, 0, 0, 0, 0, 0),
            24: mav.MAVLink_gps_raw_int_message(0, 4, 0, 0, 0, 0, 0, 0, 0, 11),
            33: mav.MAVLink_global_position_int_message(0, -353632620, 1491652370, 0, 0, 0, 0, 0, 0),
        }
        shown = run_verb(capsys, "status", "-e", vehicle.endpoint)
        assert shown.code == 0, shown.err
        assert shown.out.splitlines()[:5] == [
            "vehicle   ArduPilot rover 1", "mode      GUIDED", "state     ARMED, active", "control   --",
            "pre-arm   not ready to arm",
        ]  # fmt: skip
        assert "battery   11.8 V 73 %" in shown.out
        assert "gps       3D fix, 11 satellites" in shown.out
        [record] = run_verb(capsys, "status", "--json", "-e", vehicle.endpoint).records
        assert (record["mode"], record["armed"], record["voltage"], record["prearm"]) == ("GUIDED", True, 11.8, False)
        assert (record["lat"], record["lon"], record["groundspeed"]) == (-35.363262, 149.165237, None)
        watched = run_verb(capsys, "status", "--watch", "--for", "0.2", "--json", "-e", vehicle.endpoint).records
        assert [each["armed"] for each in watched] == [True]
        assert watched[0]["time"].endswith("Z")


def test_status_asks_again_a_vehicle_that_refuses_at_first(capsys: Capture) -> None:
    refusals = iter([Result.TEMPORARILY_REJECTED])
    with foreign_vehicle() as vehicle:
        vehicle.telemetry = {
            1: mav.MAVLink_sys_status_message(PREARM, PREARM, PREARM, 0, 11800, -1, 73, 0, 0, 0, 0, 0, 0),
            24: mav.MAVLink_gps_raw_int_message(0, 4, 0, 0, 0, 0, 0, 0, 0, 11),
            33: mav.MAVLink_global_position_int_message(0, -353632620, 1491652370, 0, 0, 0, 0, 0, 0),
        }
        vehicle.answers[Command.REQUEST_MESSAGE] = lambda command: next(refusals, None)
        shown = run_verb(capsys, "status", "-e", vehicle.endpoint)
        assert next(refusals, None) is None
        for line in ("pre-arm   ready to arm", "battery   11.8 V 73 %", "gps       3D fix, 11 satellites"):
            assert line in shown.out
        assert "position  -35.3632620 149.1652370" in shown.out


def test_a_message_before_the_first_heartbeat_does_not_count() -> None:
    """The state of a vehicle begins with its HEARTBEAT: what came before must be requested."""
    verb = LoneVerb((254, 190), None, 1)
    core = verb.core
    status = mav.MAVLink_sys_status_message(PREARM, PREARM, PREARM, 0, 11800, -1, 73, 0, 0, 0, 0, 0, 0)
    early = received(m.SysStatus(*(getattr(status, name) for name in status.fieldnames)))
    verb.receive(early, 0.0)
    assert (core.contacts, core.heard) == ({}, {})
    verb.receive(received(heartbeat()), 0.1)
    verb.receive(early, 0.2)
    assert (1, m.SysStatus) in core.heard


def test_changes_are_printed_once_each_and_texts_before_them(capsys: Capture) -> None:
    verb = LoneVerb((254, 190), None, 1)
    core = verb.core
    verb.receive(received(heartbeat(1)), 1.0)
    contact = core.contacts[1]
    printers = [
        ChangePrinter(
            contact,
            Output("status", as_json=as_json, quiet=True),
            lambda now: {"state": "ARMED" if contact.state.armed else "disarmed"},
            lambda now: {"armed": contact.state.armed},
        )
        for as_json in (False, True)
    ]

    def printed(now: float) -> tuple[list[str], list[Any]]:
        for printer in printers:
            printer.print_changes(now)
        out = capsys.readouterr().out.splitlines()
        return [each[10:] for each in out if each[0] != "{"], [json.loads(each) for each in out if each[0] == "{"]

    assert printed(1.0)[0] == ["Rover 1: state disarmed"]
    verb.receive(received(heartbeat(1)), 2.0)
    assert printed(2.0) == ([], [])
    verb.receive(received(m.StatusText(severity=4, text=b"Throttle \x1b[31marmed")), 3.0)
    verb.receive(received(heartbeat(0, base=0x81)), 3.0)
    lines, records = printed(3.0)
    assert lines == ["Rover 1: warning: Throttle \ufffd[31marmed", "Rover 1: state ARMED"]
    assert [(each.get("severity"), each.get("armed")) for each in records] == [("WARNING", None), (None, True)]
    assert records[0]["time"].endswith("Z")


def test_a_text_that_lost_a_chunk_is_printed_with_a_gap(capsys: Capture) -> None:
    verb = LoneVerb((254, 190), None, 1)
    core = verb.core
    verb.receive(received(heartbeat(1)), 1.0)
    contact = core.contacts[1]
    printer = ChangePrinter(contact, Output("status", as_json=False, quiet=True), lambda now: {}, lambda now: {})
    verb.receive(received(m.StatusText(3, b"PreArm: ".ljust(50, b"b"), 91, 0)), 1.0)
    verb.receive(received(m.StatusText(3, b" end", 91, 2)), 1.0)
    verb.tick(3.5)
    printer.print_changes(3.5)
    assert capsys.readouterr().out[10:] == f"Rover 1: error: {'PreArm: '.ljust(50, 'b')} [...] end\n"
    assert contact.state.build_view(3.5).prearm_reason.endswith("[...] end")


def test_status_names_a_breach_and_a_failsafe_without_a_name(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.telemetry = {1: mav.MAVLink_sys_status_message(FENCE, FENCE, 0, 0, 11800, -1, 73, 0, 0, 0, 0, 0, 0)}
        shown = run_verb(capsys, "status", "-e", vehicle.endpoint)
        assert "failsafe  outside the fence" in shown.out
    verb = LoneVerb((254, 190), None, 1)
    core = verb.core
    verb.receive(received(heartbeat(1)), 1.0)
    contact = core.contacts[1]
    verb.receive(received(heartbeat(status=5)), 1.0)
    assert _failsafes(contact.state.build_view(1.0)) == "not named; HEARTBEAT says CRITICAL"


def test_a_speed_of_nothing_has_no_sign() -> None:
    verb = LoneVerb((254, 190), None, 1)
    core = verb.core
    verb.receive(received(heartbeat(1)), 1.0)
    contact = core.contacts[1]
    verb.receive(received(m.Attitude(0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)), 1.0)
    verb.receive(received(m.LocalPositionNed(0, 0.0, 0.0, 0.0, -0.01, 0.0, 0.0)), 1.0)
    view = contact.state.build_view(1.0)
    assert view.speed is not None
    assert view.speed < 0
    assert _speed(view) == "0.0 m/s"


def test_plain_prints_changes_in_place_of_a_screen(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.mode = 4
        [line] = run_verb(capsys, "--plain", "--for", "0.3", vehicle.endpoint).out.splitlines()
        shown = line.partition(": ")[2]
        assert shown.startswith("mode HOLD, state disarmed, standby, control --, pre-arm "), line
        assert shown.endswith("failsafe none, link up"), line
        wrong = run_verb(capsys, "status", "--changes", "-e", vehicle.endpoint)
        assert (wrong.code, wrong.err) == (2, "mavhelm: --changes and --for belong to status --watch\n")


def test_vehicles_lists_every_vehicle_on_all_links(capsys: Capture) -> None:
    with foreign_vehicle() as one, foreign_vehicle(system=7) as other:
        listed = run_verb(capsys, "vehicles", "-e", one.endpoint, "-e", other.endpoint)
        assert [line.split()[0] for line in listed.out.splitlines()] == ["id", "1", "7"]
        records = run_verb(capsys, "vehicles", "--json", "-e", one.endpoint, "-e", other.endpoint).records
        assert [each["vehicle"] for each in records] == [1, 7]


def test_links_count_frames_of_unknown_ids_as_unknown_only() -> None:
    counts = {(1, 1): SourceCount(400, 32), (255, 190): SourceCount(10, 0)}
    cells = _link_cells(LinkReport("udpin:127.0.0.1:14550", frames=410, unknown=32, sources=counts))
    assert (cells[5], cells[7]) == ("0", "32")


def test_links_show_what_arrives_with_and_without_a_vehicle(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        silent = f"udpin:127.0.0.1:{free_port()}"
        both = run_verb(capsys, "links", "--for", "1.1", "-e", vehicle.endpoint, "-e", silent)
        states = [line.split("  ")[-1] for line in both.out.splitlines()[1:]]
        assert (both.code, states) == (0, [" MAVLink".strip(), "nothing heard"])
        alone = run_verb(capsys, "links", "--for", "1.1", "--wait", "0.1", "--json", "-e", silent)
        assert (alone.code, alone.records[0]["frames"]) == (ExitCode.NO_VEHICLE, 0)


def test_a_vehicle_is_chosen_by_its_printed_name(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        assert run_verb(capsys, "status", "-v", "ArduPilot rover 1", "-e", vehicle.endpoint).code == 0
        wrong = run_verb(capsys, "status", "-v", "Rover", "--wait", "2", "-e", vehicle.endpoint)
        assert (wrong.code, "no vehicle Rover on" in wrong.err) == (ExitCode.NO_VEHICLE, True), wrong.err
        assert "but 1" in wrong.err, "what was heard is listed"
