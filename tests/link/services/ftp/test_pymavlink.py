"""pymavlink's own FTP client against our vehicle, in virtual time."""

from __future__ import annotations

import random
from collections import deque
from pathlib import Path
from typing import Any

import pytest
from pymavlink import mavftp

from dialects import messages as m
from tests.link.ftp_rig import LOG, FtpRig
from tests.link.services_world import from_gcs, messages


class Clock:
    """Stands in for the module `time` inside pymavlink, so that its patience costs nothing."""

    def __init__(self) -> None:
        self.now = 1000.0

    def time(self) -> float:
        self.now += 0.0001
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += seconds


class Master:
    """What pymavlink's client takes for a connection: our server, and a link that loses."""

    source_system, source_component = 255, 190

    def __init__(self, vehicle: FtpRig, clock: Clock, loss: float) -> None:
        self.mav = self
        self._vehicle, self._clock, self._loss = vehicle, clock, loss
        self._dice = random.Random(4)
        self._inbox: deque[Any] = deque()

    def file_transfer_protocol_send(self, network: int, system: int, component: int, payload: bytes) -> None:
        if self._dice.random() >= self._loss:
            question = from_gcs(m.FileTransferProtocol(network, system, component, payload))
            self._arrive(self._vehicle.server.receive(question, self._clock.now))

    def recv_match(self, **_: Any) -> Any:
        if not self._inbox:
            self._clock.now += 0.02
            self._arrive(self._vehicle.server.tick(self._clock.now))
        return self._inbox.popleft() if self._inbox else None

    def _arrive(self, outgoing: list[Any]) -> None:
        self._inbox.extend(message for message in messages(outgoing) if self._dice.random() >= self._loss)


def pymavlinks(vehicle: FtpRig, monkeypatch: pytest.MonkeyPatch, loss: float = 0.0) -> mavftp.MAVFTP:
    clock = Clock()
    monkeypatch.setattr(mavftp, "time", clock)
    return mavftp.MAVFTP(Master(vehicle, clock, loss), 1, 1)


def got(client: mavftp.MAVFTP, path: str) -> bytes | None:
    """What its `get` brings."""
    result: list[bytes] = []

    def keep(file: Any) -> None:
        if file is not None:
            result.append(file.read())

    client.cmd_get([path], callback=keep)
    client.process_ftp_reply("get", timeout=300)
    return result[0] if result else None


@pytest.mark.parametrize("loss", [0.0, 0.1])
@pytest.mark.parametrize("size", [0, 80, 1000, 10_240, 100_000])
def test_pymavlink_downloads_what_we_serve(size: int, loss: float, monkeypatch: pytest.MonkeyPatch) -> None:
    data = random.Random(size).randbytes(size)
    client = pymavlinks(FtpRig(logs={"1.bin": data}), monkeypatch, loss)
    assert got(client, "/logs/1.bin") == data


def test_pymavlink_downloads_one_after_the_other(monkeypatch: pytest.MonkeyPatch) -> None:
    client = pymavlinks(FtpRig(), monkeypatch)
    assert got(client, "@PARAM/param.pck?withdefaults=1") == b"packed[('withdefaults', '1')]"
    assert got(client, "/nothing") is None
    assert got(client, "/logs/1.bin") == LOG


def test_pymavlink_lists_what_we_serve(monkeypatch: pytest.MonkeyPatch) -> None:
    client = pymavlinks(FtpRig(), monkeypatch)
    for path, names in (("/", ["@PARAM", "general.json.xz", "logs", "missions"]), ("/logs", ["1.bin", "2.bin"])):
        listed = client.cmd_list([path])
        assert listed.error_code == mavftp.FtpError.Success
        assert sorted(entry.name for entry in listed.directory_listing or []) == names


def test_pymavlink_uploads_and_removes(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    vehicle = FtpRig()
    client = pymavlinks(vehicle, monkeypatch)
    local = tmp_path / "new.plan"
    local.write_bytes(b"{" + bytes(1000))
    client.cmd_put([str(local), "/missions/new.plan"])
    assert client.process_ftp_reply("put", timeout=300).error_code == mavftp.FtpError.Success
    assert vehicle.written == [("new.plan", local.read_bytes())]
    assert client.cmd_rm(["/missions/new.plan"]).error_code == mavftp.FtpError.Success
    assert vehicle.written[-1] == ("new.plan", None)
    assert client.cmd_rm(["/logs/1.bin"]).error_code == mavftp.FtpError.FileProtected
    assert client.cmd_crc(["/logs/1.bin"]).error_code == mavftp.FtpError.Success
