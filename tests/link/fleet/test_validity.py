"""Until when certificates hold, and who is told before they end."""

from __future__ import annotations

import asyncio
import base64
import re
import subprocess
from datetime import datetime
from pathlib import Path

import pytest
from msgspec.structs import replace

from link.bridge.fleet.fleet_file import AUTHORITY, ROUTER
from link.bridge.fleet.members import add_member, new_fleet
from link.bridge.fleet.router_command import _end_warnings
from link.endpoint import Side, parse_endpoint
from link.fleet.transport import open_fleet
from link.fleet.validity import valid_until, warning_of
from tests.ports import free_port

DAY = 86400.0


def certificate(folder: Path, days: int) -> bytes:
    subprocess.run(
        ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-keyout",
         "own.key", "-subj", "/CN=alice-1", "-days", str(days), "-out", "own.pem"],
        cwd=folder, check=True, capture_output=True,
    )  # fmt: skip
    return (folder / "own.pem").read_bytes()


@pytest.mark.parametrize("days", [30, 3650, 36500])
def test_the_end_is_that_which_openssl_shows(tmp_path: Path, days: int) -> None:
    """After 2049 it is written in another form."""
    until = valid_until(certificate(tmp_path, days))
    assert until is not None
    command = ["openssl", "x509", "-noout", "-dates", "-dateopt", "iso_8601", "-in", "own.pem"]
    shown = subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, text=True).stdout
    begins, ends = re.findall(r"=(\S+ \S+)Z", shown)
    parsed = datetime.fromisoformat(f"{ends}+00:00").timestamp()
    assert until == parsed
    assert until - datetime.fromisoformat(f"{begins}+00:00").timestamp() == days * DAY


def test_it_is_warned_of_in_the_last_90_days(tmp_path: Path) -> None:
    pem = certificate(tmp_path, 365)
    until = valid_until(pem)
    assert until is not None
    assert warning_of("alice", pem, until - 91 * DAY, "renew") is None
    assert warning_of("alice", pem, 0.0, "renew") is None, "a clock that was never set"
    near = warning_of("alice", pem, until - 42 * DAY, "renew it") or ""
    assert re.fullmatch(r"the certificate of alice ends on \d{4}-\d\d-\d\d, in 42 days: renew it", near)
    after = warning_of("alice", pem, until + DAY, "renew it") or ""
    assert re.fullmatch(r"the certificate of alice ended on \d{4}-\d\d-\d\d: renew it", after)


EMPTY = b"-----BEGIN CERTIFICATE-----\nAAAA\n-----END CERTIFICATE-----"


async def test_a_member_is_told_in_its_log(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    farm = new_fleet(tmp_path / "farm", "farm", ["127.0.0.1"], free_port())
    own = add_member(farm, "alice", "drive")
    short = base64.b64encode(certificate(tmp_path, 30)).decode()
    for certificate_of_the_file in (None, short):
        if certificate_of_the_file:
            own.write_text(re.sub(r'("connect_certificate_base64": )".*"', rf'\1"{short}"', own.read_text()))
        transport = open_fleet(replace(parse_endpoint(f"zenoh:{own}/farm"), side=Side.GROUND_STATION))
        transport.start(asyncio.get_running_loop(), lambda _: None, lambda _: None)
        transport.close()
        warned = re.findall(
            r"the certificate of alice ends on .* in (?:29|30) days: `(.*)` makes a new file", caplog.text
        )
        assert warned == (["mavhelm bridge fleet renew alice"] if certificate_of_the_file else [])


def test_a_router_is_told_of_its_own_and_of_the_authority(tmp_path: Path) -> None:
    farm = new_fleet(tmp_path / "farm", "farm", ["127.0.0.1"], free_port()).parent
    assert list(_end_warnings(farm)) == []
    for name in (ROUTER, AUTHORITY):
        (farm / name).write_bytes(certificate(tmp_path, 30))
    router, authority = _end_warnings(farm)
    assert re.match(
        r"the certificate of the router ends on .* days: mavhelm bridge fleet renew router, and restart", router
    )
    assert re.match(r"the certificate of the fleet's authority ends on .* days: make the fleet anew", authority)


@pytest.mark.parametrize("text", [b"", b"no certificate", EMPTY])
def test_what_is_no_certificate_is_warned_of_by_nobody(text: bytes) -> None:
    assert valid_until(text) is None
    assert warning_of("alice", text, 0.0, "renew") is None
