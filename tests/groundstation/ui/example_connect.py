"""Views of the Connect screen to draw."""

from __future__ import annotations

from groundstation.recent.recent import RecentEndpoints
from groundstation.recent.recent_file import RecentFile
from groundstation.views.connect import ConnectView, HeardRow, LinkAttempt, ListenRow, PortRow
from tests.groundstation.ui.examples import NOON, waiting

PORTS = (
    PortRow(path="/dev/ttyACM0", description="Pixhawk 6C", ids="3185:0053", driver="cdc_acm"),
    PortRow(path="/dev/ttyAMA0", driver="uart-pl011", holder="agetty (pid 412)"),
    PortRow(path="/dev/ttyS7", allowed=False),
    PortRow(path="/dev/ttyUSB0", description="SiK radio", ids="0403:6015", driver="ftdi_sio"),
)
LISTENING = (ListenRow("udpin:127.0.0.1:14550"), ListenRow("udpin:127.0.0.1:14551"))
ROVER = HeardRow(
    endpoint="udpin:127.0.0.1:14550", address="127.0.0.1:50211", system=1, name="ArduPilot rover 1", mode="HOLD",
    armed=False, silence=0.1, rate=98.0, bytes_per_second=3400.0, driver=0,
)  # fmt: skip
OTHER = HeardRow(
    endpoint="udpin:127.0.0.1:14551", address="127.0.0.1:40112", system=3, name="Rover 3", mode="MANUAL", armed=True,
    silence=0.1, rate=33.0, bytes_per_second=1100.0, driver=245,
)  # fmt: skip
OPEN = HeardRow(
    endpoint="serial:/dev/ttyUSB0:57600", system=7, name="Rover 7", mode="MANUAL", armed=False, silence=0.4, open=True
)
CONNECT = ConnectView(heard=(ROVER, OTHER), ports=PORTS, listening=LISTENING)
"""Two vehicles are heard, nothing is open."""

NOTHING = ConnectView(listening=(LISTENING[0], ListenRow("udpin:127.0.0.1:14551", "port 14551 is in use; stop it")))
"""Nothing is heard, and no serial port is there."""

FAILED = ConnectView(
    heard=(OPEN,),
    ports=PORTS,
    listening=LISTENING,
    attempts=(LinkAttempt(1, "tcpout:10.0.0.7:5760", "failed", "host '10.0.0.7' is not known", 4.0),),
    endpoints=("serial:/dev/ttyUSB0:57600",),
)
"""A radio is open, another link cannot be opened."""

UNCONNECTED = waiting(endpoints=(), links=(), addresses=("192.168.4.20",))
"""No link is open."""

DAY = 86400.0


def remember(now: float) -> None:
    """Fill the file of the endpoints used before, with times that look the same on every day."""
    recent = RecentEndpoints().add("udpout:192.168.4.1:14550", NOON, "Survey boat")
    recent = recent.add("tcpout:10.0.0.7:5760", now - DAY, "ArduRover SITL").add("udpin:0.0.0.0:14550", now - DAY)
    RecentFile().update(lambda _: recent.pin("udpin:0.0.0.0:14550"))


def forget() -> None:
    """Empty the file."""
    RecentFile().update(lambda _: RecentEndpoints())
