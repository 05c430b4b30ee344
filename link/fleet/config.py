"""The Zenoh configuration of one endpoint: from a file of `bridge fleet`, another Zenoh file, or a bare locator."""

from __future__ import annotations

import base64
import json
import os
import re
import socket
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from link.endpoint import FLEET_NAME, Endpoint, Side
from link.fleet.traffic import CLASSES
from link.runtime.install_hint import install_command
from link.signing.role import ROLES, SigningRole
from link.transport.transport import LinkError

if TYPE_CHECKING:
    import zenoh

LEASE = 2000
"""ms of silence after which a session ends. TCP repeats what got lost 0.2, 0.6, 1.4 and 3 s after it was sent: a new
session after 2 s is faster than the last of them. Zenoh's own 10 s would hide a dead router."""
OPEN_TIMEOUT = 2000
"""ms for a router to open a session, which takes five round trips: the kernel of a frozen one still accepts.
Zenoh's own are 10 s."""
SEND_BUFFER = 32768
"""Bytes that the kernel buffers, where nothing can overtake."""
BATCH_SIZE = 8192
"""Bytes of a batch. Zenoh's own 64 KiB are 2 s of telemetry on a slow radio link."""
MAX_MESSAGE = 65536
"""Bytes of one message that is put together from its parts; a longer one is dropped as it arrives. A frame has at most
280, and Zenoh's own limit is 1 GiB: one put of a member would fill the memory of the router and of a vehicle."""
MAX_WAIT_FOR_ROOM = 200
"""us that a put may hold up the event loop when the queue is full; then the frame is dropped."""

SETTINGS: dict[str, Any] = {
    "transport/shared_memory/enabled": False,  # its counters end at 349 sessions of one computer
    "transport/link/tx/lease": LEASE,
    "transport/unicast/open_timeout": OPEN_TIMEOUT,
    "transport/link/tx/batch_size": BATCH_SIZE,
    "transport/link/rx/max_message_size": MAX_MESSAGE,
    "transport/link/tx/queue/congestion_control/drop/wait_before_drop": MAX_WAIT_FOR_ROOM,
    "transport/link/tx/queue/size/real_time": 16,  # batches, of one frame each where frames are express
    "transport/link/tx/queue/size/interactive_high": 16,
    "transport/link/tx/queue/size/data": 4,
    "qos/publication": [
        {
            "key_exprs": [f"fleet/*/*/up/*/*/{each.word}/**", f"fleet/*/*/down/*/*/*/{each.word}/**"],
            "config": {
                "priority": each.priority.value,
                "express": each.express,
                "reliability": "reliable" if each.reliable else "best_effort",
                "congestion_control": "drop",
            },
        }
        for each in CLASSES
    ],
    "transport/link/tcp/so_sndbuf": SEND_BUFFER,
    "transport/link/tls/so_sndbuf": SEND_BUFFER,
    "scouting/multicast/enabled": False,
    "scouting/gossip/enabled": False,
}
"""What every program of a fleet sets, the router included."""

THREADS_VARIABLE = "ZENOH_RUNTIME"
"""Environment variable with the threads of Zenoh in this process, which a user may set."""
THREADS = (
    "(app: (worker_threads: 2), acc: (handover: app), net: (handover: app), rx: (handover: app), tx: (handover: app))"
)
"""One pool for everything, in an end: between Zenoh's own five pools a frame wakes one thread after the other, which
adds 0.1 ms. A single thread would be held up for 2 s by the end of a session whose router is silent. A router keeps the
five: who has read a frame there waits for room in the queue to others, and must not keep the thread that makes room.
"""

_CLIENT: dict[str, Any] = {
    "mode": "client",  # peers behind one router do not hear each other
    "listen/endpoints": [],
    "connect/timeout_ms": 0,  # one attempt: the caller tries again, and can say why it failed
    "connect/exit_on_failure": True,
}
VEHICLE_ROLE = "vehicle"
"""`role` of a vehicle's file, where that of an operator is a word of link.signing.keys.ROLES."""


class FleetConfig(msgspec.Struct, frozen=True):
    """How to connect, and as whom."""

    zenoh: zenoh.Config
    routers: tuple[str, ...]
    """Locators."""
    name: str
    """Of the operator or vehicle, as its certificate proves; the computer's name without a certificate."""
    role: str | None
    """"vehicle", or what the certificate of an operator may do; None: not known."""
    is_proven: bool
    """Both ends show certificates of the fleet, so that no stranger can send."""
    certificate: bytes = b""
    """PEM of its own certificate, if the file holds it."""

    @property
    def operator_role(self) -> SigningRole | None:
        """What an operator may do; None if it is not known."""
        return None if self.role is None else ROLES.get(self.role)


def load_zenoh() -> Any:
    """Return the module zenoh. Raises LinkError with the command that installs it."""
    try:
        import zenoh
    except ImportError:
        raise LinkError(f"fleets need the package eclipse-zenoh: {install_command('fleet')}") from None
    return zenoh


def load_config(endpoint: Endpoint) -> FleetConfig:
    """Return the configuration of an endpoint. Raises LinkError: file, error, remedy."""
    module = load_zenoh()
    os.environ.setdefault(THREADS_VARIABLE, THREADS)  # read when the first session opens
    config = _read_file(module, endpoint) if ".json" in endpoint.locator else module.Config()
    if "json" not in endpoint.locator:
        config.insert_json5("connect/endpoints", json.dumps([endpoint.locator]))
    apply_settings(config, SETTINGS | _CLIENT)
    routers = tuple(_get(config, "connect/endpoints"))
    if not routers:
        raise LinkError(f"{endpoint.text}: {endpoint.locator} names no router; add it to connect/endpoints")
    whose = (_get(config, "metadata") or {}).get("mavhelm") or {}
    name, role = str(whose.get("name") or own_name()), whose.get("role")
    if problem := _mismatch(endpoint, whose):
        raise LinkError(f"{endpoint.text}: {endpoint.locator} {problem}")
    return FleetConfig(config, routers, name, role, _is_proven(config, routers), _own_certificate(config))


def is_private(endpoint: Endpoint) -> bool:
    """Return whether strangers cannot send to an endpoint: the router asks everybody for a certificate.

    Behind a router without certificates may be anybody, also if it runs on this computer.
    """
    try:
        return load_config(endpoint).is_proven
    except LinkError:  # opening the link says what is wrong
        return False


def apply_settings(config: zenoh.Config, settings: dict[str, Any]) -> None:
    """Set these keys of a configuration."""
    for key, value in settings.items():
        config.insert_json5(key, json.dumps(value))


def own_name() -> str:
    """Return a name of this computer that a key may hold."""
    found = re.search(FLEET_NAME, socket.gethostname())
    return found[0] if found else "unnamed"


def _read_file(module: Any, endpoint: Endpoint) -> zenoh.Config:
    path = Path(endpoint.locator).expanduser()
    try:
        path.read_bytes()
        config: zenoh.Config = module.Config.from_file(str(path))
    except OSError as error:
        raise LinkError(f"{endpoint.text}: {path}: {error.strerror}") from None
    except module.ZError as error:
        why = " ".join(str(error).split(" at /")[0].split())
        raise LinkError(f"{endpoint.text}: {path} is not a Zenoh configuration: {why[:160]}") from None
    return config


def _mismatch(endpoint: Endpoint, whose: dict[str, Any]) -> str | None:
    """Return why a file is not that of this program, or None. Files of other origin do not say whose they are."""
    name, role = whose.get("name"), whose.get("role")
    if role is None:
        return None
    if whose.get("fleet") != endpoint.fleet:
        return f"is of the fleet {whose.get('fleet')}, not {endpoint.fleet}"
    if endpoint.side is Side.GROUND_STATION and role == VEHICLE_ROLE:
        return "is the file of a vehicle; make one for an operator: mavhelm bridge fleet add operator NAME --role drive"
    if endpoint.side is Side.VEHICLE and role != VEHICLE_ROLE:
        return "is the file of an operator; make one for this vehicle: mavhelm bridge fleet add vehicle NAME"
    if role == VEHICLE_ROLE and name != endpoint.vehicle:
        return f"is the file of {name}; write {endpoint.locator}/{endpoint.fleet}/{name}"
    return None


def _is_proven(config: zenoh.Config, routers: tuple[str, ...]) -> bool:
    certified = all(
        _get(config, f"transport/link/tls/{each}_base64") or _get(config, f"transport/link/tls/{each}")
        for each in ("root_ca_certificate", "connect_certificate", "connect_private_key")
    )
    return certified and all(each.startswith(("tls/", "quic/")) for each in routers)


def _own_certificate(config: zenoh.Config) -> bytes:
    try:
        return base64.b64decode(_get(config, "transport/link/tls/connect_certificate_base64") or "")
    except (ValueError, TypeError):
        return b""


def _get(config: zenoh.Config, key: str) -> Any:
    """Return a value of a configuration; None if it has none."""
    try:
        return json.loads(config.get_json(key))
    except (ValueError, _zenoh_error()):
        return None


def _zenoh_error() -> type[Exception]:
    error: type[Exception] = load_zenoh().ZError
    return error
