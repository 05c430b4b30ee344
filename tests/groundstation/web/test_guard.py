"""The guard of the web server: every combination of Host, Origin and token."""

from __future__ import annotations

import pytest
from msgspec.structs import replace

from groundstation.web.guard import HEADERS, Guard, WebRequest

GUARD = Guard(8000, "right")
OWN = "http://127.0.0.1:8000"
PAGE = WebRequest("/", ("127.0.0.1:8000",), (), token=None, cookie="right")
SOCKET = WebRequest("/ws", ("127.0.0.1:8000",), (OWN,), token=None, cookie="right")


def status(request: WebRequest) -> int | None:
    refusal = GUARD.refuse(request)
    return None if refusal is None else refusal.status


def test_our_page_is_admitted_by_its_cookie_and_first_by_address() -> None:
    assert status(PAGE) is None
    assert status(SOCKET) is None
    assert status(replace(PAGE, cookie=None, token="right")) is None
    local = replace(SOCKET, hosts=("LocalHost:8000",), origins=("http://localhost:8000",))
    assert status(local) is None


@pytest.mark.parametrize(
    "hosts",
    [
        (),
        ("evil.example",),
        ("127.0.0.1",),
        ("127.0.0.1:8001",),
        ("127.0.0.1:8000", "evil.example"),
        ("evil:8000",),
        ("",),
    ],
)
def test_name_made_to_point_here_is_refused_even_with_the_token(hosts: tuple[str, ...]) -> None:
    assert status(replace(PAGE, hosts=hosts, token="right")) == 403
    assert status(replace(SOCKET, hosts=hosts)) == 403


@pytest.mark.parametrize(
    "origins",
    [
        ("https://evil.example",),
        ("null",),
        ("http://127.0.0.1:8001",),
        ("https://127.0.0.1:8000",),
        ("http://localhost:8000",),
        (OWN, "https://evil.example"),
    ],
)
def test_another_page_is_refused_also_with_the_cookie(origins: tuple[str, ...]) -> None:
    assert status(replace(SOCKET, origins=origins)) == 403
    assert status(replace(PAGE, origins=origins)) == 403


def test_a_socket_without_an_origin_is_no_browser() -> None:
    assert status(replace(SOCKET, origins=())) == 403


@pytest.mark.parametrize("token", [None, "", "wrong", "right ", "rightright", "\udc80"])
def test_without_the_token_there_is_nothing(token: str | None) -> None:
    assert status(replace(PAGE, cookie=token)) == 401
    assert status(replace(PAGE, cookie=None, token=token)) == 401
    assert status(replace(SOCKET, cookie=token)) == 401
    assert status(WebRequest("/static/js/textual.js", PAGE.hosts, (), token="right", cookie=token)) == 401


def test_a_socket_takes_no_token_of_an_address() -> None:
    assert status(replace(SOCKET, cookie=None, token="right")) == 401


def test_nothing_from_outside_may_be_loaded() -> None:
    policy = dict(rule.strip().split(" ", 1) for rule in HEADERS["Content-Security-Policy"].split(";"))
    assert policy["default-src"] == "'none'"
    assert {source for rule in policy.values() for source in rule.split()} == {
        "'none'", "'self'", "'unsafe-inline'", "data:",
    }  # fmt: skip
    assert policy["script-src"] == "'self'"


def test_servers_of_two_ports_have_two_cookies() -> None:
    assert (GUARD.cookie_name, Guard(8001, "right").cookie_name) == ("mavhelm-8000", "mavhelm-8001")
