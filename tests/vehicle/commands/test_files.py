"""Time, ping, files, logs and what is not offered: every question has an answer."""

from __future__ import annotations

import json
import lzma
import struct

import pytest

from dialects import messages as m
from dialects.enums import Capability, Command, Result
from link.services.ftp.protocol import FtpError, FtpOpcode, FtpPacket, crc32, parse_packet
from link.services.param.pack import MAGIC
from tests.vehicle.bench import DRIVER, OTHER, Bench, said
from vehicle.params import TABLE


def ask(bench: Bench, op: FtpOpcode, data: bytes = b"", *, size: int | None = None, named: bool = False) -> FtpPacket:
    """The answer of the file server."""
    before = len(bench.all(m.FileTransferProtocol))
    question = FtpPacket(before * 7, op, 0, data, size=size)
    bench.say(question.message(1, 1), introduced=not named, named=named)
    (answer,) = bench.all(m.FileTransferProtocol)[before:]
    return parse_packet(answer)


def fetch(bench: Bench, path: bytes) -> bytes:
    """A file that fits into one answer or a few."""
    (length,) = struct.unpack("<I", ask(bench, FtpOpcode.OPEN, path).data)
    content = b""
    while len(content) < length:
        packet = FtpPacket(10_000 + len(content), FtpOpcode.READ, 0, b"", len(content), size=239)
        bench.say(packet.message(1, 1))
        content += parse_packet(bench.newest(m.FileTransferProtocol)).data
    ask(bench, FtpOpcode.TERMINATE)
    return content


def test_time_and_ping_are_echoed() -> None:
    bench = Bench()
    bench.say(m.Timesync(tc1=0, ts1=123))
    assert bench.newest(m.Timesync).ts1 == 123
    assert bench.newest(m.Timesync).tc1 > 0
    bench.say(m.Ping(1, 7, 0, 0))
    assert (bench.newest(m.Ping).seq, bench.newest(m.Ping).target_system) == (7, DRIVER)


@pytest.mark.parametrize("kind", [0, 1, 2])
def test_there_are_no_plans(kind: int) -> None:
    bench = Bench()
    bench.say(m.MissionRequestList(1, 1, kind))
    answer = bench.newest(m.MissionCount)
    assert (answer.target_system, answer.count, answer.mission_type) == (DRIVER, 0, kind)


def test_there_are_no_logs() -> None:
    bench = Bench()
    bench.say(m.LogRequestList(1, 1, 0, 0xFFFF))
    bench.wait(0.1)
    assert bench.newest(m.LogEntry).num_logs == 0
    assert ask(bench, FtpOpcode.LIST, b"/logs").data[0] == FtpError.END_OF_FILE


def test_the_root_lists_what_there_is() -> None:
    listing = ask(Bench(), FtpOpcode.LIST, b"/").data.split(b"\0")
    assert [line.partition(b"\t")[0] for line in listing if line] == [
        b"D@PARAM", b"Dlogs", b"Dmissions", b"Fgeneral.json.xz", b"Fparameter.json.xz",
    ]  # fmt: skip


def test_all_parameters_are_one_file() -> None:
    content = fetch(Bench(), b"@PARAM/param.pck")
    assert struct.unpack_from("<HHH", content) == (MAGIC, len(TABLE), len(TABLE))


def test_what_the_parameters_mean_can_be_read() -> None:
    bench = Bench()
    assert bench.command(Command.REQUEST_MESSAGE, m.ComponentMetadata.id) is Result.ACCEPTED
    told = bench.newest(m.ComponentMetadata)
    packed = fetch(bench, told.uri.removeprefix("mftp://").encode())
    assert crc32(packed) == told.file_crc
    (kind,) = json.loads(lzma.decompress(packed))["metadataTypes"]
    described = json.loads(lzma.decompress(fetch(bench, kind["uri"].removeprefix("mftp://").encode())))
    assert [each["name"] for each in described["parameters"]] == [parameter.name for parameter in TABLE]


def test_files_are_offered_in_the_capabilities() -> None:
    bench = Bench()
    bench.command(Command.REQUEST_MESSAGE, m.AutopilotVersion.id)
    assert bench.newest(m.AutopilotVersion).capabilities & Capability.FTP


@pytest.mark.parametrize("path", [b"/etc/passwd", b"../rover.toml", b"@PARAM/../x", b"/logs/none", b"\xff" * 239])
def test_nothing_else_is_there(path: bytes) -> None:
    answer = ask(Bench(), FtpOpcode.OPEN, path)
    assert (answer.op, answer.data[0]) == (FtpOpcode.NAK, FtpError.NOT_FOUND)


def test_plans_are_files() -> None:
    bench = Bench()
    plan = b"QGC WPL 110\n0\t0\t3\t16\t0\t0\t0\t0\t47.1\t8.5\t0\t1\n"
    path = b"/missions/mission.waypoints"
    assert ask(bench, FtpOpcode.CREATE, path).op == FtpOpcode.ACK
    bench.say(FtpPacket(500, FtpOpcode.WRITE, 0, plan).message(1, 1))
    assert ask(bench, FtpOpcode.TERMINATE).op == FtpOpcode.ACK
    bench.say(m.MissionRequestList(1, 1, 0))
    assert bench.newest(m.MissionCount).count == 1
    assert b"47.1000000\t8.5000000" in fetch(bench, path)


def test_a_file_without_a_plan_or_a_place_is_refused_in_words() -> None:
    bench = Bench()
    assert ask(bench, FtpOpcode.CREATE, b"/missions/fence.waypoints").op == FtpOpcode.ACK
    bench.say(FtpPacket(500, FtpOpcode.WRITE, 0, b"no plan").message(1, 1))
    assert ask(bench, FtpOpcode.TERMINATE).op == FtpOpcode.NAK
    bench.wait(0.1)
    assert said(bench, "Fence file rejected: line 1 is not 'QGC WPL 110'")
    answer = ask(bench, FtpOpcode.CREATE, b"/missions/other.txt")
    assert (answer.op, answer.data[0]) == (FtpOpcode.NAK, FtpError.PROTECTED)


def test_only_the_driver_in_control_writes_plans() -> None:
    bench = Bench()
    assert bench.arm(system=OTHER) is Result.ACCEPTED
    assert ask(bench, FtpOpcode.CREATE, b"/missions/mission.waypoints").op == FtpOpcode.NAK


@pytest.mark.parametrize("op", [FtpOpcode.CREATE, FtpOpcode.REMOVE, FtpOpcode.OPEN_TO_WRITE])
def test_nothing_is_written(op: FtpOpcode) -> None:
    assert ask(Bench(), op, b"/general.json.xz").op == FtpOpcode.NAK


def test_a_named_address_may_ask_before_its_heartbeat() -> None:
    bench = Bench()
    assert ask(bench, FtpOpcode.LIST, b"/", named=True).op == FtpOpcode.ACK
    asked = m.CommandLong(1, 1, Command.REQUEST_MESSAGE, 0, m.AutopilotVersion.id, 0, 0, 0, 0, 0, 0)
    bench.say(asked, introduced=False, named=True)
    assert bench.newest(m.CommandAck).result == Result.ACCEPTED
    bench.say(m.ParamRequestRead(1, 1, b"SPEED_MAX", -1), introduced=False, named=True)
    assert bench.newest(m.ParamValue).param_id == "SPEED_MAX"


def test_but_it_may_not_change_anything() -> None:
    bench = Bench()
    bench.say(m.ParamSet(1, 1, b"SPEED_MAX", 3.0, 9), introduced=False, named=True)
    arm = m.CommandLong(1, 1, Command.COMPONENT_ARM_DISARM, 0, 1, 0, 0, 0, 0, 0, 0)
    bench.say(arm, introduced=False, named=True)
    assert not bench.all(m.ParamValue)
    assert not bench.armed


def test_for_another_system_there_is_silence() -> None:
    bench = Bench()
    bench.wait(0.5)
    count = len(bench.sent)
    bench.say(m.MissionRequestList(2, 1, 0))
    bench.say(m.LogRequestList(1, 9, 0, 0xFFFF))
    bench.say(FtpPacket(1, FtpOpcode.LIST, 0, b"/").message(2, 1))
    bench.say(m.Ping(1, 7, 1, 1))
    assert len(bench.sent) == count
