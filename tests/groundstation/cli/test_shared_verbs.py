"""`mavhelm attach` and `serve`: what is said without a station, with two, and for wrong arguments."""

from __future__ import annotations

import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from groundstation.cli.main import main
from groundstation.station_socket.folder import make_folder, socket_path
from link.runtime.install_hint import install_command
from link.runtime.local_socket import open_socket
from tests.ports import free_port


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    return make_folder()


@pytest.fixture
def two_stations(folder: Path) -> Iterator[None]:
    with ExitStack() as stack:
        for pid in (11, 12):
            sock = stack.enter_context(open_socket())
            sock.bind(str(socket_path(folder, pid)))
            sock.listen()
        yield


def test_attach_without_a_station(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["attach"]) == 2
    said = "mavhelm: no station runs here: `mavhelm` or `mavhelm serve --headless` starts one\n"
    assert capsys.readouterr().err == said


@pytest.mark.usefixtures("two_stations")
def test_attach_with_two_stations(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["attach"]) == 2
    assert capsys.readouterr().err == "mavhelm: stations 11, 12 run here: name one, as in `attach 11`\n"


def test_attach_in_a_folder_of_everybody(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder.chmod(0o777)
    assert main(["attach"]) == 2
    assert capsys.readouterr().err == f"mavhelm: {folder} is open to other users: chmod 700 {folder}\n"


def test_a_folder_of_everybody_is_named_by_serve_and_by_verbs(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder.chmod(0o777)
    said = f"{folder} is open to other users: chmod 700 {folder}\n"
    assert main(["serve", "--headless", "udpin:127.0.0.1:1"]) == 2
    assert capsys.readouterr().err == f"mavhelm: {said}"
    assert main(["status", "-e", f"udpin:127.0.0.1:{free_port()}", "--wait", "0.01"]) == 3
    assert capsys.readouterr().err.startswith(f"mavhelm: no running station is used: {said}")


def test_serve_needs_headless(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serve"]) == 2
    assert "give --headless or --web; `mavhelm --keep` opens a screen" in capsys.readouterr().err


def test_serve_says_what_it_cannot_open() -> None:
    command = [sys.executable, "-m", "groundstation", "serve", "--headless", "udpin:192.0.2.1:14550"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2
    assert done.stderr.startswith("mavhelm: udpin:192.0.2.1:14550")
    assert done.stderr.count("\n") == 1


def test_serve_in_browser_names_port_in_use_or_a_missing_package(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        assert main(["serve", "--web", "--port", str(port), "udpin:127.0.0.1:1"]) == 2
        assert capsys.readouterr().err == f"mavhelm: --port {port}: Address already in use; choose another one\n"
    with pytest.raises(SystemExit):
        main(["serve", "--web", "--port", "0"])
    assert "'0' is not a number from 1 to 65535" in capsys.readouterr().err
    monkeypatch.setattr("groundstation.web.launch.PACKAGES", ("no_such_package",))
    assert main(["serve", "--web", "udpin:127.0.0.1:1"]) == 2
    assert install_command("web") in capsys.readouterr().err
