"""What is safe without a setting: loopback, private files, clean texts, no code from data, no key on a screen."""

from __future__ import annotations

import ast
import ipaddress
import logging
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from dialects import messages as m
from dialects import rover
from groundstation.config.defaults import DEFAULT_ENDPOINT
from groundstation.connect.listener import ENDPOINTS
from groundstation.station.messages.message_traffic import MessageTraffic
from groundstation.verbs.common.output import Output
from link.endpoint import parse_endpoint
from tests.groundstation.verbs.verb_runs import run_verb
from tests.waits import PATIENCE
from vehicle.cli.options import GROUND_STATION
from vehicle.runtime.log import DaemonLog

ROOT = Path(__file__).parents[1]
PACKAGES = ("dialects", "link", "vehicle", "groundstation")
FORBIDDEN_MODULES = frozenset({"pickle", "cPickle", "marshal", "shelve", "dill", "yaml", "telnetlib", "xmlrpc"})
FORBIDDEN_CALLS = frozenset({"eval", "exec", "compile", "__import__", "os.system", "os.popen", "tempfile.mktemp"})
"""They turn data into code, or into a command of a shell."""
EVIL = "\x1b]0;owned\x07\x1b[2Jtext"


def sources() -> Iterator[Path]:
    return (path for package in PACKAGES for path in (ROOT / package).rglob("*.py") if path.name != "rover.py")


def called(node: ast.Call) -> str:
    target = node.func
    if isinstance(target, ast.Attribute) and isinstance(target.value, ast.Name):
        return f"{target.value.id}.{target.attr}"
    return target.id if isinstance(target, ast.Name) else ""


def dangers(tree: ast.AST) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (each.name for each in node.names if each.name.partition(".")[0] in FORBIDDEN_MODULES)
        elif isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] in FORBIDDEN_MODULES:
            yield str(node.module)
        elif isinstance(node, ast.Call):
            if called(node) in FORBIDDEN_CALLS:
                yield called(node)
            yield from ("shell=" for each in node.keywords if each.arg == "shell")


def test_no_data_becomes_code() -> None:
    assert list(dangers(ast.parse("import pickle\nfrom yaml import load\neval('1')\nrun('x', shell=True)"))) == [
        "pickle", "yaml", "eval", "shell=",
    ]  # fmt: skip
    found = {str(path.relative_to(ROOT)): list(dangers(ast.parse(path.read_text()))) for path in sources()}
    assert len(found) > 400
    assert {path: what for path, what in found.items() if what} == {}


@pytest.mark.parametrize("endpoint", [DEFAULT_ENDPOINT, GROUND_STATION, *ENDPOINTS])
def test_endpoints_that_nobody_named_stay_on_this_computer(endpoint: str) -> None:
    assert ipaddress.ip_address(parse_endpoint(endpoint).host).is_loopback


def test_what_a_vehicle_writes_is_for_its_user_only(tmp_path: Path) -> None:
    folder = tmp_path / "state" / "logs"
    script = f"""
import os
os.umask(0o022)
from pathlib import Path
from vehicle.motors.log import MotorLog
from vehicle.runtime.lock import lock_state_folder
from vehicle.runtime.log_file import LogFile
from vehicle.storage.file_writer import FileWriter
with lock_state_folder(Path({str(folder)!r})):
    writer = FileWriter(Path({str(folder)!r}))
    writer.write("parameters.json", lambda: b"x")
    writer.close()
    LogFile({str(folder / "vehicle.log")!r}).write(b"x")
    MotorLog({str(folder / "motors.log")!r}).write("x")
"""
    subprocess.run([sys.executable, "-c", script], check=True, timeout=PATIENCE, cwd=ROOT)
    assert folder.stat().st_mode & 0o077 == 0
    files = {path.name: path.stat().st_mode & 0o777 for path in folder.iterdir()}
    assert files == {"parameters.json": 0o600, "vehicle.log": 0o600, "motors.log": 0o600}


def test_escape_sequences_of_a_vehicle_reach_no_terminal_or_log(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    output = Output("status", as_json=False, quiet=False)
    output.line(f"one\n{EVIL}")
    output.error(EVIL)
    Output("status", as_json=True, quiet=False).record(name=EVIL)
    log = DaemonLog(str(tmp_path / "vehicle.log"))
    logging.getLogger("vehicle").warning("%s", EVIL)
    log.close()
    printed = capsys.readouterr()
    assert printed.out.count("\n") == 3
    for text in (printed.out, printed.err, (tmp_path / "vehicle.log").read_text()):
        assert "text" in text
        assert text.replace("\n", "").isprintable()


def test_setup_signing_is_counted_and_its_key_is_not_kept() -> None:
    traffic = MessageTraffic(255, 190)
    key = bytes(range(1, 33))
    traffic.count(m.SetupSigning(1, 1, key, 5), 254, 190, 1.0, known=False)
    [(_, kind)] = traffic.kinds()
    assert isinstance(kind.newest, m.SetupSigning)
    assert bytes(kind.newest.secret_key) == bytes(32)
    ping = rover.MAVLink_ping_message(1, 2, 3, 4)
    assert m.hide_key(ping) is ping


def test_a_key_is_refused_on_the_command_line(capsys: pytest.CaptureFixture[str]) -> None:
    run = run_verb(capsys, "send", "SETUP_SIGNING", "secret_key=1", "-e", "udpout:127.0.0.1:9")
    assert run.code == 2
    assert "use `mavhelm sign setup`" in run.err


def test_a_process_with_keys_dumps_no_core(tmp_path: Path) -> None:
    script = (
        "import resource; from pathlib import Path; from link.signing.key_file import load_keys\n"
        f"load_keys(Path({str(tmp_path / 'keys.toml')!r})); print(resource.getrlimit(resource.RLIMIT_CORE))"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], check=True, timeout=PATIENCE, cwd=ROOT, capture_output=True, text=True
    )
    assert done.stdout.strip() == "(0, 0)"
