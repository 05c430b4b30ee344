"""Paths of MAVLink FTP: none leads out of the tree of served files."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.services.ftp.protocol import FtpError, FtpOpcode
from tests.link.ftp_rig import FtpRig, error
from tests.rows import each_row

PATHS = [
    b"../../etc/shadow",
    b"/../etc/shadow",
    b"/etc/shadow",
    b"/logs/../general.json.xz",
    b"/logs/../../etc/shadow",
    b"/logs/./1.bin",
    b"/logs//1.bin",
    b"///etc/shadow",
    b"..",
    b".",
    b"/logs/..",
    b"\\etc\\shadow",
    b"/logs/..\\1.bin",
    b"/logs/1.bin\0/../../etc/shadow",
    b"/logs/1.bin/x",
    b"@PARAM/../logs/1.bin",
    b"@MISSION/mission.dat",
    b"\xff\xfe",
    b"/logs/1.bin\n",
    b"\x1b[2J",
    b"A" * 239,
    b"/" * 239,
    b"../" * 79,
]


@each_row("path", PATHS)
@each_row(
    "op",
    [FtpOpcode.OPEN, FtpOpcode.CRC, FtpOpcode.CREATE, FtpOpcode.OPEN_TO_WRITE, FtpOpcode.REMOVE, FtpOpcode.TRUNCATE],
)
def test_71_no_path_leads_out(path: bytes, op: FtpOpcode) -> None:
    assert error(FtpRig().ask(op, path)) in (FtpError.NOT_FOUND, FtpError.PROTECTED)


@pytest.mark.parametrize(
    "path", [b"..", b".", b"/..", b"/logs/..", b"/logs/.", b"../..", b"logs/../1.bin", b"/logs/a\\b"]
)
def test_no_folder_ever_sees_a_name_that_leads_out(path: bytes) -> None:
    assert FtpRig().tree.find(path) is None


@given(st.binary(max_size=239))
def test_only_names_that_are_served_are_found(path: bytes) -> None:
    place = FtpRig().tree.find(path)
    assert place is None or place.name == "" or ("/" not in place.name and place.name not in (".", ".."))
