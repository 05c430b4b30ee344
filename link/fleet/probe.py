"""Says why a router cannot be reached, where Zenoh only says that it cannot."""

from __future__ import annotations

import base64
import json
import re
import socket
import ssl
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import zenoh

PATIENCE = 3.0
"""s for a connection; this runs in a thread of its own."""
_STREAMS = ("tcp", "tls")
_CA = "transport/link/tls/root_ca_certificate"


def explain_failure(locator: str, config: zenoh.Config) -> str:
    """Return why no session with the router at `locator` came about, in one line."""
    protocol, _, rest = locator.partition("/")
    host, _, port = rest.partition("?")[0].rpartition(":")
    host = host.strip("[]")
    try:
        if protocol not in _STREAMS:
            socket.getaddrinfo(host, int(port))
            return f"no router answers at {locator}"
        with socket.create_connection((host, int(port)), PATIENCE) as connection:
            if protocol == "tcp":
                return f"{locator} answers, but not as a Zenoh router without certificates"
            return _explain_tls(connection, host, locator, config)
    except socket.gaierror:
        return f"host {host!r} is not known; check the name or the network"
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
