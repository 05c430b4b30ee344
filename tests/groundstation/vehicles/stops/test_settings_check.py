"""Reading the settings of a foreign vehicle: requests, repeats, restarts, and what was not answered."""

from __future__ import annotations

import math

import pytest

from dialects.messages import ParamRequestRead, ParamValue
from groundstation.vehicles.stops.ardupilot_checks import ARDUPILOT
from groundstation.vehicles.stops.settings_check import SettingsCheck
from link.core import Peer, Received


def new_check() -> SettingsCheck:
    return SettingsCheck(ARDUPILOT, 255, 190, target=(1, 1))


def value(name: str, number: float, system: int = 1) -> Received:
    message = ParamValue(name.encode(), number, 9, 1, 65535)
    return Received(message, system, 1, 0, Peer(0, "vehicle"), introduced=True)


@pytest.mark.parametrize("number", [math.nan, math.inf])
def test_no_number_is_no_setting(number: float) -> None:
    check = new_check()
    assert check.receive(value("MAV_GCS_SYSID", number), 0.0) == []
    assert not check.warnings
    assert [check.obeys] == [None]
    check.receive(value("MAV_GCS_SYSID", 7.0), 0.0)
    assert check.receive(value("MAV_GCS_SYSID", number), 0.0) == []
    assert check.obeys == "obeys ground station 7 only and we are 255: use --system 7"


def test_an_unanswered_read_is_repeated_three_times() -> None:
    check = new_check()
    asked: list[bytes] = []
    check.receive(value("FS_GCS_ENABLE", 1.0), 0.0)
    for second in range(20):
        for outgoing in check.tick(second * 0.5):
            assert isinstance(outgoing.message, ParamRequestRead)
            asked.append(outgoing.message._param_id_raw)
    assert len(asked) == 3 * (len(ARDUPILOT.checks) - 1)
    assert "FS_GCS_ENABLE" not in [name.decode() for name in asked]


def test_only_the_checked_parameters_of_this_vehicle_count() -> None:
    check = new_check()
    assert check.receive(value("FS_GCS_ENABLE", 0.0, system=2), 0.0) == []
    for number in range(1000):
        assert check.receive(value(f"OTHER_{number}", 0.0), 0.0) == []
    assert not check.warnings
    assert [check.obeys] == [None]
    assert check._params.params == {}, "a flood of names must not grow a table"


def requests(check: SettingsCheck, start: float, end: float) -> list[str]:
    """Return the parameters that were requested from `start` to `end`."""
    sent = [each.message for tick in range(int(2 * start), int(2 * end)) for each in check.tick(tick / 2)]
    return [each.param_id for each in sent if isinstance(each, ParamRequestRead)]


def test_parameters_that_were_not_answered_are_named() -> None:
    check = new_check()
    requests(check, 0.0, 3.0)
    assert not check.warnings
    assert [check.obeys] == [None]
    assert check.pop_missing_warning() == []
    check.receive(value("FS_GCS_ENABLE", 1.0), 3.0)
    requests(check, 3.0, 4.0)
    words = "could not read, trying again: RC_OVERRIDE_TIME, FS_THR_ENABLE, MAV_GCS_SYSID"
    assert check.warnings == (words,)
    assert [check.pop_missing_warning() for _ in range(2)] == [[words], []], "logged once"
    check.receive(value("SYSID_MYGCS", 255.0), 5.0)
    check.receive(value("RC_OVERRIDE_TIME", 1.0), 5.0)
    assert check.warnings == ("could not read, trying again: FS_THR_ENABLE",)
    check.receive(value("FS_THR_ENABLE", 1.0), 5.0)
    assert not check.warnings
    assert [check.obeys] == [None]


def test_parameters_are_requested_until_they_are_known() -> None:
    check = new_check()
    assert set(requests(check, 0.0, 100.0)) == set(ARDUPILOT.checks)
    for name in ("RC_OVERRIDE_TIME", "FS_GCS_ENABLE", "SYSID_MYGCS"):
        check.receive(value(name, 1.0), 100.0)
    requests(check, 100.0, 104.0)
    assert set(requests(check, 104.0, 200.0)) == {"FS_THR_ENABLE"}
    check.receive(value("FS_THR_ENABLE", 1.0), 200.0)
    requests(check, 200.0, 204.0)
    assert requests(check, 204.0, 300.0) == []


def test_a_restart_reads_everything_again() -> None:
    check = new_check()
    requests(check, 0.0, 1.0)
    for name in ARDUPILOT.checks:
        check.receive(value(name, 0.0), 1.0)
    assert check.warnings
    check.restart()
    assert not check.warnings
    assert [check.obeys] == [None]
    assert check.link_loss_action is None
    assert set(requests(check, 1.0, 2.0)) == set(ARDUPILOT.checks)
