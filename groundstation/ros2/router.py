"""Which Zenoh router a node connects to, and how: a locator, or a Zenoh configuration file, e.g. with certificates."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import msgspec
import zenoh

from link.fleet.config import OPEN_TIMEOUT, apply_settings
from link.transport.transport import LinkError

SETTINGS: dict[str, Any] = {
    "mode": "client",  # a router passes between clients and peers, wherever they run
    "listen/endpoints": [],
    "connect/timeout_ms": 0,
    "connect/exit_on_failure": True,
    "transport/shared_memory/enabled": False,
    "transport/link/tx/lease": 3000,
    "transport/unicast/open_timeout": OPEN_TIMEOUT,
    "scouting/multicast/enabled": False,
    "scouting/gossip/enabled": False,
}
_LOCATOR = re.compile(r"(tcp|udp|tls|quic|ws)/\S+:\d+(\?\S*)?")


class RosRouter(msgspec.Struct, frozen=True):
    """The router of a session."""

    locator: str
    config: zenoh.Config


def load_router(text: str) -> RosRouter:
    """Return the router of a locator such as tcp/localhost:7447, or of a file. Raises LinkError, in one line."""
    if ".json" in text:
        return _load_file(text)
    if not _LOCATOR.fullmatch(text):
        raise LinkError(f"{text!r} is neither a locator such as tcp/localhost:7447 nor a file .json5")
    config = zenoh.Config()
    apply_settings(config, SETTINGS | {"connect/endpoints": [text]})
    return RosRouter(text, config)


def _load_file(text: str) -> RosRouter:
    path = Path(text).expanduser()
    try:
        path.read_bytes()
        config = zenoh.Config.from_file(str(path))
        locators = json.loads(config.get_json("connect/endpoints"))
    except OSError as error:
        raise LinkError(f"{path}: {error.strerror}") from None
    except (zenoh.ZError, ValueError) as error:
        why = " ".join(str(error).split(" at /")[0].split())
        raise LinkError(f"{path} is not a Zenoh configuration: {why[:160]}") from None
    if not isinstance(locators, list) or not locators:
        raise LinkError(f"{path} names no router; add it to connect/endpoints")
    apply_settings(config, SETTINGS)
    return RosRouter(str(locators[0]), config)
