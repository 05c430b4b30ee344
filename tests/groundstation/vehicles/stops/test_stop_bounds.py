"""What stops a vehicle, and when: each autopilot by its own parameters, and nothing that none of them says."""

from __future__ import annotations

import pytest

from dialects.enums import Autopilot, VehicleType
from groundstation.snapshot.drive import StopBound
from groundstation.vehicles.stops.stop_bounds import find_rules, stop_bounds
from groundstation.vehicles.stops.stop_rules import StopFacts

ROVER = {
    "MAN_TIMEOUT": 0.45, "FS_TIMEOUT": 1.5, "FS_GCS_ENABLE": 1.0, "FS_GCS_TIMEOUT": 5.0, "OPR_TIMEOUT": 10.0,
    "FENCE_ENABLE": 1.0, "FENCE_ACTION": 2.0, "BATT_LOW_VOLT": 10.5, "FS_LOW_ACT": 2.0, "CRASH_ANGLE": 45.0,
}  # fmt: skip
ARDUPILOT = {
    "RC_OVERRIDE_TIME": 3.0, "FS_THR_ENABLE": 1.0, "FS_GCS_ENABLE": 1.0, "FS_GCS_TIMEOUT": 5.0, "FS_TIMEOUT": 1.5,
    "FS_ACTION": 2.0,
}  # fmt: skip
PX4 = {
    "COM_RC_IN_MODE": 1.0, "COM_RC_LOSS_T": 0.5, "NAV_RCL_ACT": 2.0, "COM_FAIL_ACT_T": 5.0,
    "COM_DL_LOSS_T": 10.0, "NAV_DLL_ACT": 2.0,
}  # fmt: skip

Row = tuple[str, str, float | str | None]


def rows(bounds: tuple[StopBound, ...]) -> list[Row]:
    """Return name, what follows, and the bound; "never" where it is switched off."""
    return [(each.name, each.does, "never" if each.never else each.bound) for each in bounds]


def ours(params: dict[str, float], **facts: object) -> tuple[StopBound, ...]:
    return stop_bounds(find_rules(0, own_dialect=True), StopFacts(params, **facts))  # type: ignore[arg-type]


def foreign(autopilot: int, params: dict[str, float], **facts: object) -> tuple[StopBound, ...]:
    return stop_bounds(find_rules(autopilot, own_dialect=False), StopFacts(params, **facts))  # type: ignore[arg-type]


def test_our_vehicle() -> None:
    assert rows(ours(ROVER)) == [
        ("no command", "neutral", 0.45), ("no command", "HOLD", 1.95), ("no station", "HOLD", 5.0),
        ("no key", "neutral", 10.0), ("fence", "HOLD", 0.0), ("battery", "HOLD", 10.5), ("tilt", "disarm", 45.0),
    ]  # fmt: skip


def test_what_is_switched_off_in_our_vehicle_is_never() -> None:
    off = ROVER | {"FS_GCS_ENABLE": 0.0, "FENCE_ENABLE": 0.0, "BATT_LOW_VOLT": 0.0, "CRASH_ANGLE": 0.0}
    assert [name for name, _, bound in rows(ours(off)) if bound == "never"] == [
        "no station", "fence", "battery", "tilt",
    ]  # fmt: skip


def test_auto_goes_on_without_a_station_if_it_is_set_so() -> None:
    params = ROVER | {"FS_GCS_ENABLE": 2.0}
    assert rows(ours(params))[2] == ("no station", "HOLD", 5.0)
    assert rows(ours(params, drives_itself=True))[2] == ("no station", "nothing", "never")


def test_the_bars_fill_as_silence_grows() -> None:
    bounds = ours(ROVER, command_age=0.225, quiet=1.0, input_age=5.0, voltage=12.5, tilt=9.0)
    assert [each.share for each in bounds] == [0.5, pytest.approx(0.115, abs=0.001), 0.2, 0.5, None, 0.84, 0.2]
    assert ours(ROVER, command_age=9.0)[0].share == 1.0


def test_the_keys_do_not_count_while_the_vehicle_drives_itself() -> None:
    bounds = ours(ROVER, command_age=9.0, drives_itself=True)
    assert [each.value for each in bounds[:2]] == [None, None]


def test_an_ardurover_with_its_defaults() -> None:
    """Measured: 3.0 s with a receiver, 0.53 s and HOLD at 2.05 s without one; no failsafe for the ground station."""
    assert rows(foreign(Autopilot.ARDUPILOT, ARDUPILOT | {"FS_GCS_ENABLE": 0.0})) == [
        ("no command", "RC input", 3.0), ("... no RC", "neutral", 0.5), ("... no RC", "HOLD", 2.0),
        ("no station", "nothing", "never"),
    ]  # fmt: skip


def test_an_ardurover_with_a_ground_station_failsafe() -> None:
    """Measured: HOLD at 6.59 s with FS_GCS_TIMEOUT 5 and FS_TIMEOUT 1.5."""
    assert rows(foreign(Autopilot.ARDUPILOT, ARDUPILOT))[3] == ("no station", "HOLD", 6.5)
    assert rows(foreign(Autopilot.ARDUPILOT, ARDUPILOT | {"FS_ACTION": 1.0}))[3] == ("no station", "RTL", 6.5)
    assert rows(foreign(Autopilot.ARDUPILOT, ARDUPILOT | {"FS_ACTION": 0.0}))[3] == ("no station", "nothing", "never")


@pytest.mark.parametrize(
    ("changes", "never"),
    [
        ({"RC_OVERRIDE_TIME": -1.0}, ["RC_OVERRIDE_TIME"]),
        ({"FS_THR_ENABLE": 0.0}, ["FS_THR_ENABLE", "FS_TIMEOUT"]),
        ({"FS_THR_ENABLE": 0.0, "RC_OVERRIDE_TIME": -1.0}, ["RC_OVERRIDE_TIME", "FS_THR_ENABLE", "FS_TIMEOUT"]),
    ],
)
def test_an_ardurover_that_never_stops(changes: dict[str, float], never: list[str]) -> None:
    bounds = foreign(Autopilot.ARDUPILOT, ARDUPILOT | changes)
    assert [each.source for each in bounds if each.never] == never


def test_an_endless_override_promises_nothing_without_a_receiver() -> None:
    bounds = foreign(Autopilot.ARDUPILOT, ARDUPILOT | {"RC_OVERRIDE_TIME": -1.0})
    assert [(each.does, each.bound) for each in bounds if each.name == "... no RC"] == [("--", None), ("--", None)]


@pytest.mark.parametrize("kind", [2, 12], ids=["quadrotor", "submarine"])
def test_other_ardupilots_are_promised_nothing(kind: int) -> None:
    assert all((each.bound, each.never, each.does) == (None, False, "--") for each in
               foreign(Autopilot.ARDUPILOT, ARDUPILOT, kind=kind))  # fmt: skip


def test_a_boat_is_an_ardurover() -> None:
    boat = foreign(Autopilot.ARDUPILOT, ARDUPILOT, kind=VehicleType.SURFACE_BOAT)
    assert rows(boat) == rows(foreign(Autopilot.ARDUPILOT, ARDUPILOT))


def test_a_px4_rover() -> None:
    """Measured with its defaults: HOLD 0.7 s after the last demand, RTL 5.9 s."""
    assert rows(foreign(Autopilot.PX4, PX4)) == [
        ("no command", "HOLD", 0.5),
        ("... then", "RTL", 5.5),
        ("no station", "RTL", 15.0),
    ]
    holding = foreign(Autopilot.PX4, PX4 | {"NAV_RCL_ACT": 1.0, "NAV_DLL_ACT": 1.0})
    assert rows(holding) == [("no command", "HOLD", 0.5), ("... then", "--", None), ("no station", "HOLD", 10.0)]
    disarming = foreign(Autopilot.PX4, PX4 | {"NAV_RCL_ACT": 6.0, "NAV_DLL_ACT": 6.0})
    assert rows(disarming) == [("no command", "disarm", 0.5), ("... then", "--", None), ("no station", "disarm", 10.0)]
    off = foreign(Autopilot.PX4, PX4 | {"NAV_RCL_ACT": 0.0, "NAV_DLL_ACT": 0.0})
    assert rows(off) == [
        ("no command", "nothing", "never"),
        ("... then", "--", None),
        ("no station", "nothing", "never"),
    ]
    ignoring = foreign(Autopilot.PX4, PX4 | {"COM_RC_IN_MODE": 4.0})
    assert rows(ignoring)[0] == ("no command", "ignored", None)


@pytest.mark.parametrize("params", [ROVER, ARDUPILOT, PX4], ids=["ours", "ArduPilot", "PX4"])
def test_what_was_not_read_is_not_known(params: dict[str, float]) -> None:
    """Each parameter alone missing: the bounds that need it are not known; none gets another value."""
    autopilot = {id(ARDUPILOT): Autopilot.ARDUPILOT, id(PX4): Autopilot.PX4}.get(id(params))

    def bounds(known: dict[str, float]) -> list[Row]:
        return rows(ours(known) if autopilot is None else foreign(autopilot, known))

    whole = bounds(params)
    for name in params:
        others = {key: each for key, each in params.items() if key != name}
        for row, complete in zip(bounds(others), whole, strict=True):
            assert row == complete or row[1] == "--" or row[2] is None, name
    assert all(bound is None for _, _, bound in bounds({}))


def test_a_vehicle_of_an_unknown_make_is_promised_nothing() -> None:
    assert rows(foreign(Autopilot.GENERIC, ROVER)) == [("no command", "--", None), ("no station", "--", None)]
