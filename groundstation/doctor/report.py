"""The doctor's report as text, for a bug: no keys, and no addresses beyond private ones."""

from __future__ import annotations

import ipaddress
import re
from collections.abc import Iterable, Iterator

from groundstation.views.doctor import DoctorView
from link.runtime.diagnosis import MARKS, TITLE_WIDTH, Health

HIDDEN = "(hidden)"

_ENDPOINT = re.compile(r"\b(udpin|udpout|udp|tcpin|tcpout|tcp|tcpserver|tcpclient):(\[[^\]]*\]|[^\s:,]+)")
_IPV4 = re.compile(r"\b\d{1,3}(?:\.\d{1,3}){3}\b")
_IPV6 = re.compile(r"\[?\b[0-9a-fA-F]{0,4}(?::[0-9a-fA-F]{0,4}){2,7}(?:%\w+)?\b\]?")


def hide_addresses(text: str) -> str:
    """Return a text with every host name and every public address hidden; private ones stay."""
    text = _ENDPOINT.sub(lambda found: f"{found[1]}:{_shown(found[2])}", text)
    text = _IPV4.sub(lambda found: _shown(found[0]), text)
    return _IPV6.sub(lambda found: _shown(found[0]) if _is_address(found[0]) else found[0], text)


def _is_address(text: str) -> bool:
    try:
        ipaddress.ip_address(text.strip("[]").partition("%")[0])
    except ValueError:
        return False
    return True


def _shown(host: str) -> str:
    """Return a private address as it is, anything else hidden."""
    try:
        address = ipaddress.ip_address(host.strip("[]").partition("%")[0])
    except ValueError:
        return HIDDEN
    private = address.is_private or address.is_loopback or address.is_unspecified or address.is_link_local
    return host if private else HIDDEN


def format_report(view: DoctorView, lines: Iterable[tuple[str, str]] = (), log: Iterable[str] = ()) -> str:
    """Return the report. `lines` are names and texts about the programs, `log` the newest messages."""
    text = "\n".join(_sections(view, lines, log))
    return hide_addresses("".join(each if each.isprintable() or each == "\n" else "?" for each in text)) + "\n"


def _sections(view: DoctorView, lines: Iterable[tuple[str, str]], log: Iterable[str]) -> Iterator[str]:
    yield f"mavhelm doctor: {view.name or 'no vehicle'}"
    yield from (f"{name:<12} {text}" for name, text in (*lines, *view.facts))
    yield ""
    yield from format_chain(view)
    if view.sensors:
        yield ""
        yield from (f"{MARKS[each.health]:<3}{each.name}" for each in view.sensors)
    if view.texts:
        yield ""
        yield from (f"{each.age:.0f} s ago: {each.text}" for each in view.texts)
    yield from ("", *log)


def format_chain(view: DoctorView) -> Iterator[str]:
    """Return a line for each link of the chain, and what to do below those that need it."""
    for row in view.rows:
        yield f"{MARKS[row.health]:<3}{row.title:<{TITLE_WIDTH}}{row.evidence}"
        if row.advice and row.health in (Health.WARNING, Health.FAULT):
            yield f"{'':<{TITLE_WIDTH + 3}}-> {row.advice}"
