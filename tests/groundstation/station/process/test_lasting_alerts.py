"""Lasting alerts are written to the log file once."""

from __future__ import annotations

from groundstation.snapshot import LinkView
from groundstation.station.process.lasting_alerts import MOST, LastingAlerts
from tests.groundstation.ui.examples import snapshot, vehicle

BAD = snapshot(
    vehicle=vehicle(obeys="obeys ground station 250 only", warnings=("FS_THR_ENABLE 0: never stops",)),
    links=(LinkView(name="udp", problem="another dialect"),),
    id_conflict="ground station 255/230 uses our system id",
)


def test_each_is_written_once() -> None:
    alerts = LastingAlerts()
    assert alerts.new_in(snapshot()) == []
    assert alerts.new_in(BAD) == [
        "ground station 255/230 uses our system id",
        "udp: another dialect",
        "Rover 1: obeys ground station 250 only",
        "Rover 1: FS_THR_ENABLE 0: never stops",
    ]
    assert alerts.new_in(BAD) == []
    assert alerts.new_in(snapshot()) == []
    assert alerts.new_in(BAD) == []


def test_their_number_is_bounded() -> None:
    alerts = LastingAlerts()
    written = [
        text
        for number in range(2 * MOST)
        for text in alerts.new_in(snapshot(vehicle=vehicle(warnings=(f"warning {number}", f"and {number}"))))
    ]
    assert len(written) == MOST
