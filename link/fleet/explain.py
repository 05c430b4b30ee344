"""Says why a router that can be reached has opened no session, where Zenoh only says that it has not."""

from __future__ import annotations

import base64
import json
import re
import socket
import ssl
from typing import TYPE_CHECKING

from link.fleet.locator import read_locator

if TYPE_CHECKING:
    import zenoh

PATIENCE = 1.0
"""s for a connection: the next attempt waits for it."""
_CA = "transport/link/tls/root_ca_certificate"


def explain_failure(locator: str, config: zenoh.Config) -> str:
    """Return why no session with the router at `locator` came about, in one line."""
    place = read_locator(locator)
    if place is None or place.protocol not in ("tcp", "tls"):
        is_quic = place is not None and place.protocol == "quic"
        return f"the router at {locator} refuses this certificate" if is_quic else f"no router answers at {locator}"
    try:
        with socket.create_connection((place.host, place.port), PATIENCE) as connection:
            if place.protocol == "tcp":
                return f"{locator} answers, but not as a Zenoh router without certificates"
            return _explain_tls(connection, place.host, locator, config)
    except OSError as error:
        return f"no router at {locator} ({(error.strerror or str(error) or 'no answer').lower()})"


def _explain_tls(connection: socket.socket, host: str, locator: str, config: zenoh.Config) -> str:
    try:
        with _context(config).wrap_socket(connection, server_hostname=host):
            return f"the router at {locator} refuses this certificate, or is none"
    except ssl.SSLCertVerificationError as error:
        if "match" in error.verify_message.lower():
            names = re.sub(r"[^-\w. :']", "", error.verify_message)
            return f"the router's certificate is for another address ({names})"
        return f"the router's certificate is not of this fleet ({error.verify_message})"
    except TimeoutError:
        return f"the router at {locator} does not answer"
    except (OSError, ValueError):
        return f"{locator} answers, but not with TLS"


def _context(config: zenoh.Config) -> ssl.SSLContext:
    """Return a context that trusts the authority of the configuration."""
    inline, path = (json.loads(config.get_json(key) or "null") for key in (f"{_CA}_base64", _CA))
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    if inline:
        context.load_verify_locations(cadata=base64.b64decode(inline).decode())
    elif path:
        context.load_verify_locations(cafile=path)
    else:
        context.load_default_certs()
    return context
