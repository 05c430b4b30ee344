"""The list of serial ports, and who has them open."""

from __future__ import annotations

import contextlib

import pytest

from groundstation.connect.port_scan import PortScan
from groundstation.station_socket.connect import running_stations
from groundstation.ui.connect.tables import ports_value
from groundstation.views.connect import PortRow
from link.runtime.wsl import SERIAL_HINT
from link.transport.serial_ports import SerialPort
from tests.groundstation.screen import Screen
from tests.waits import wait_until


def scan(*ports: SerialPort) -> tuple[PortRow, ...]:
    """Return what a scan makes of these ports."""
    with contextlib.closing(PortScan(lambda: list(ports))) as made:
        made.look(0.0)
        wait_until(lambda: bool(made.rows))
        return made.rows


@pytest.mark.e2e
def test_a_port_that_a_station_of_ones_own_has_is_named_as_such() -> None:
    with Screen() as screen:
        wait_until(lambda: running_stations() == [screen.client.pid])
        pid = screen.client.pid
        ours, other = scan(
            SerialPort("/dev/ttyUSB0", holder=f"python3 (pid {pid})"), SerialPort("/dev/ttyUSB1", holder="x (pid 1)")
        )
    assert (ours.station, other.station) == (pid, 0)
    shown = ports_value((ours, other), (), 57600, 0)
    assert [row[2].text for row in ports_value((ours, other), (), 57600, None).rows] == ["in use: yours", "in use: x"]
    assert f"a station of yours ({pid}) has it open: mavhelm attach" in [note.text for note in shown.notes]


def test_in_wsl_the_empty_list_says_where_the_ports_are() -> None:
    [linux], [wsl] = (ports_value((), (), 57600, None, wsl=wsl).notes for wsl in (False, True))
    assert linux.text == "plug one in: it appears here"
    assert wsl.text == SERIAL_HINT
