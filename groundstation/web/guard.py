"""Guard of the web server: who may open a tab. No I/O.

A page of any other site can make this browser send requests to this machine. Host keeps out a name that is made to
point here (DNS rebinding), Origin a foreign page, and the token other users of this machine.
"""

from __future__ import annotations

import hmac
from collections.abc import Sequence

import msgspec

TOKEN = "token"
"""Parameter of the first address."""

HOSTS = ("127.0.0.1", "localhost")

HEADERS = {
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; font-src 'self'; "
        "img-src 'self' data:; connect-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
    ),
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-store",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
}
"""Of every answer: nothing from outside is loaded, no other page embeds this one, and the token is passed to nobody."""


class WebRequest(msgspec.Struct, frozen=True):
    """What decides of a request; headers as often as they were sent."""

    path: str
    hosts: Sequence[str]
    origins: Sequence[str]
    token: str | None
    """Of its address."""
    cookie: str | None


class RequestRefusal(msgspec.Struct, frozen=True):
    """An HTTP status and one line."""

    status: int
    line: str


class Guard(msgspec.Struct, frozen=True):
    """The rules for one port and one token."""

    port: int
    token: str
    socket_path: str = "/ws"

    @property
    def cookie_name(self) -> str:
        """Name of the cookie: browsers do not keep the ports of a host apart."""
        return f"mavhelm-{self.port}"

    def refuse(self, request: WebRequest) -> RequestRefusal | None:
        """Return why a request is not answered; None if it is."""
        names = {f"{host}:{self.port}" for host in HOSTS}
        if len(request.hosts) != 1 or request.hosts[0].lower() not in names:
            return RequestRefusal(403, f"wrong Host: open http://127.0.0.1:{self.port}")
        if not self._may_origin(request):
            return RequestRefusal(403, "wrong Origin: only this server's own page may open it")
        if not self.admits(request):
            return RequestRefusal(401, "no valid token: open the address that `mavhelm serve --web` has printed")
        return None

    def admits(self, request: WebRequest) -> bool:
        """Return whether a token is right: of the cookie, or of the first address, which no socket has."""
        if self._is_token(request.cookie):
            return True
        return request.path == "/" and self._is_token(request.token)

    def _may_origin(self, request: WebRequest) -> bool:
        """Return whether the page that asks is our own. Browsers always send the origin of a socket."""
        own = f"http://{request.hosts[0].lower()}"
        if not request.origins:
            return request.path != self.socket_path
        return len(request.origins) == 1 and request.origins[0].lower() == own

    def _is_token(self, given: str | None) -> bool:
        return given is not None and hmac.compare_digest(given.encode(errors="replace"), self.token.encode())
