"""Files of verbs that a station runs, which are those of their shell: read and written there, over a real socket."""

from __future__ import annotations

import asyncio
import os
import random
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from groundstation.station_socket.verb_run import PIECE, RunVerb
from groundstation.verbs.client.verb_client import VerbClient
from groundstation.verbs.common.exit_codes import ExitCode
from groundstation.verbs.common.output import Output
from tests.fakes.params import Param
from tests.fakes.services import ForeignVehicle, foreign_vehicle
from tests.groundstation.verbs.remote.test_shell_verbs import Shells, with_station

DATA = random.Random(7).randbytes(2 * PIECE + 1000)


@pytest.fixture
def vehicle() -> Iterator[ForeignVehicle]:
    with foreign_vehicle() as running:
        assert running.files is not None
        running.files.files = {"/logs/1.bin": DATA}
        running.params["FS_ACTION"] = Param(2.0)
        yield running


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_files_of_several_pieces_go_both_ways(vehicle: ForeignVehicle, here: Path) -> None:
    async def use(shells: Shells) -> None:
        assert (await shells.run("ftp", "get", "/logs/1.bin")).code == ExitCode.DONE
        assert (here / "1.bin").read_bytes() == DATA
        assert not (here / "1.bin.part").exists()
        assert (await shells.run("ftp", "put", "1.bin", "/copy.bin")).code == ExitCode.DONE
        assert vehicle.files is not None
        assert vehicle.files.files["/copy.bin"] == DATA

    with_station(vehicle, use)


def test_an_interrupted_download_is_kept_and_resumed(vehicle: ForeignVehicle, here: Path) -> None:
    async def use(shells: Shells) -> None:
        client = VerbClient(shells.connect(), Output("ftp get", as_json=False, quiet=True))
        verb = asyncio.ensure_future(client.run(RunVerb(("ftp", "get", "/logs/1.bin"))))
        await shells.see(lambda: len(vehicle.of("FILE_TRANSFER_PROTOCOL")) > 4)
        verb.cancel()
        await asyncio.wait({verb})
        part = (here / "1.bin.part").read_bytes()
        assert 0 < len(part) < len(DATA)
        assert part == DATA[: len(part)]
        assert (await shells.run("ftp", "get", "/logs/1.bin")).code == ExitCode.DONE
        assert (here / "1.bin").read_bytes() == DATA

    with_station(vehicle, use)


@pytest.mark.parametrize("words", [("ftp", "get", "/logs/1.bin"), ("param", "load", "pipe")])
def test_a_killed_shell_leaves_no_verb_that_waits_for_it(
    words: tuple[str, ...], vehicle: ForeignVehicle, here: Path
) -> None:
    async def use(shells: Shells) -> None:
        os.mkfifo(here / "pipe")
        before = asyncio.all_tasks()
        link = shells.connect()
        verb = asyncio.ensure_future(VerbClient(link, Output(words[0], as_json=False, quiet=True)).run(RunVerb(words)))
        if words[0] == "ftp":
            await shells.see(lambda: len(vehicle.of("FILE_TRANSFER_PROTOCOL")) > 4)
        else:
            await shells.see(lambda: shells.station.verbs.busy)
        link.sock.shutdown(socket.SHUT_RDWR)
        verb.cancel()
        await shells.see(lambda: asyncio.all_tasks() <= before)
        assert not shells.station.verbs.busy

    with_station(vehicle, use)


def test_a_file_that_is_not_there_is_one_line(
    vehicle: ForeignVehicle, here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    async def use(shells: Shells) -> None:
        (here / "kept").write_bytes(b"kept")
        assert (await shells.run("param", "load", "none.param")).code == ExitCode.USAGE
        assert capsys.readouterr().err == "mavhelm: none.param: No such file or directory\n"
        assert (await shells.run("ftp", "get", "/logs/1.bin", "kept")).code == ExitCode.USAGE
        assert capsys.readouterr().err == "mavhelm: kept: exists already; --yes overwrites it\n"
        assert (here / "kept").read_bytes() == b"kept"

    with_station(vehicle, use)


def test_a_pipe_without_a_writer_delays_the_shell_alone(vehicle: ForeignVehicle, here: Path) -> None:
    async def use(shells: Shells) -> None:
        os.mkfifo(here / "pipe")
        waiting = asyncio.ensure_future(shells.run("param", "load", "pipe"))
        await shells.see(lambda: shells.station.verbs.busy)
        assert (await shells.run("mode", "HOLD")).code == ExitCode.DONE, "another shell"
        with open(here / "pipe", "w") as writer:  # noqa: ASYNC230 - the reader waits in its thread
            writer.write("FS_ACTION,3\n")
        assert (await waiting).code == ExitCode.DONE
        assert vehicle.params["FS_ACTION"].value == 3.0
        waiting = asyncio.ensure_future(shells.run("param", "load", "pipe"))
        await shells.see(lambda: shells.station.verbs.busy)
        waiting.cancel()
        await asyncio.wait({waiting})
        await shells.see(lambda: not shells.station.verbs.busy)

    with_station(vehicle, use)
