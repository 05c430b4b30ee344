"""View of what can be connected to: vehicles that are heard, serial ports, and how attempts to open links stand."""

from __future__ import annotations

import msgspec

from groundstation.views.base import View, ViewRequest


class ConnectRequest(ViewRequest, frozen=True):
    """All of it. While it is watched, the station listens on the usual ports without sending."""

    search: bool = False
    """Also ask the local network by multicast DNS; no MAVLink is sent."""


class HeardRow(msgspec.Struct, frozen=True, kw_only=True):
    """A vehicle that is heard."""

    endpoint: str
    """Where it can be heard, e.g. "udpin:127.0.0.1:14550"."""
    address: str = ""
    """Of the other end, where the endpoint does not name it."""
    system: int
    name: str
    mode: str
    armed: bool
    silence: float
    """Seconds since its last message."""
    rate: float = 0.0
    """Frames received per second from its address."""
    bytes_per_second: float = 0.0
    driver: int | None = None
    """System id of the ground station in control, 0 for none; None if the vehicle does not report it."""
    open: bool = False
    """It is heard over a link that is open; else nothing was sent to it."""
    announced: bool = False
    """It announces itself on the network, and was not heard."""


class PortRow(msgspec.Struct, frozen=True, kw_only=True):
    """A serial port of this machine."""

    path: str
    description: str = ""
    """What is plugged in, as it describes itself."""
    ids: str = ""
    """USB vendor and product, e.g. "0403:6015"."""
    driver: str = ""
    """Name of the kernel's driver, e.g. "ftdi_sio"."""
    holder: str = ""
    """Program that has it open, with its process id."""
    station: int = 0
    """Process id of that program if it is another station of this user; 0: it is none."""
    allowed: bool = True
    """This user may open it."""


class ListenRow(msgspec.Struct, frozen=True):
    """A port on which the station listens without sending."""

    endpoint: str
    problem: str = ""
    """Why it does not, e.g. because another program has the port."""


class LinkAttempt(msgspec.Struct, frozen=True):
    """How an AddLink stands."""

    request: int
    endpoint: str
    state: str
    """"opening", "open", "failed" (it is tried again) or "refused"."""
    problem: str = ""
    retry_in: float | None = None
    """s until the next attempt."""


class ConnectView(View, frozen=True, kw_only=True):
    """What can be connected to."""

    heard: tuple[HeardRow, ...] = ()
    ports: tuple[PortRow, ...] = ()
    listening: tuple[ListenRow, ...] = ()
    attempts: tuple[LinkAttempt, ...] = ()
    """The newest attempts to open links, oldest first."""
    endpoints: tuple[str, ...] = ()
    """Endpoints of the links that are open."""
    searching: bool = False
    """The local network is asked."""
    search_problem: str = ""
    """Why it is not, or without effect."""
