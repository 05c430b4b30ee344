"""Strangers without a certificate, who open some hundred connections to a router and say nothing.

Zenoh lets nobody new in while these fail one after the other, so the router ends itself if that takes long. The rules
of docs/fleet.md keep such connections from it.
"""

from __future__ import annotations

import re
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest
import zenoh

from link.bridge.fleet.fleet_file import FILE, read_fleet_file
from link.endpoint import parse_endpoint
from link.fleet.config import load_config
from link.fleet.locator import read_locator
from tests.e2e.fleet_programs import LOCALHOST, RouterProcess, make_fleet
from tests.e2e.namespaces import Namespaces, why_not
from tests.waits import PATIENCE, wait_until

pytestmark = [pytest.mark.slow, pytest.mark.e2e, pytest.mark.timeout(240), pytest.mark.xdist_group("strangers")]

REASON = why_not()
DOCS = Path(__file__).parents[2] / "docs" / "fleet.md"
SILENT = """\
import socket, sys
held = []
for _ in range(int(sys.argv[3])):
    each = socket.socket()
    each.setblocking(False)
    each.connect_ex((sys.argv[1], int(sys.argv[2])))
    held.append(each)
print("open", flush=True)
sys.stdin.read()
"""


def port_of(fleet: Path) -> int:
    place = read_locator(read_fleet_file(fleet / FILE).listen[0])
    assert place is not None
    return place.port


@contextmanager
def strangers(count: int, host: str, port: int, within: Sequence[str] = ()) -> Iterator[None]:
    """Another process that holds `count` silent connections."""
    command = [*within, "prlimit", "--nofile=4096", sys.executable, "-c", SILENT, host, str(port), str(count)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        assert process.stdout.readline() == b"open\n"
        yield
        process.stdin.close()


def gets_in(fleet: Path) -> bool:
    """Whether alice, who has a certificate, gets a session."""
    try:
        with zenoh.open(load_config(parse_endpoint(f"zenoh:{fleet}/alice.json5/farm")).zenoh):
            return True
    except zenoh.ZError:
        return False


@pytest.mark.parametrize(("count", "files"), [(300, 4096), (1150, 1024)])
def test_after_strangers_newcomers_get_in_or_the_router_ends(tmp_path: Path, count: int, files: int) -> None:
    fleet = make_fleet(tmp_path, alice="drive")
    with ExitStack() as stack:
        router = RouterProcess(fleet, stack, within=("prlimit", f"--nofile=256:{files}"))
        assert gets_in(fleet)
        with strangers(count, LOCALHOST[0], port_of(fleet)):
            wait_until(lambda: len(list(Path(f"/proc/{router.process.pid}/fd").iterdir())) > min(count, files - 50))
        wait_until(lambda: router.process.poll() is not None or gets_in(fleet), within=120.0)
        if router.process.poll() is not None:
            assert router.process.returncode == 1
            [line] = [each for each in router.log.read_text().splitlines() if "newcomer" in each]
            assert re.search(r"has not let a newcomer in for 3 probes in 30 s \(.*\); ending, so that", line)
            router.start()  # as Restart=always does
            wait_until(lambda: gets_in(fleet))


@pytest.mark.skipif(REASON is not None, reason=str(REASON))
def test_the_rules_of_the_docs_keep_strangers_from_the_router(tmp_path: Path) -> None:
    [rules] = re.findall(r"```nft\n(.*?)```", DOCS.read_text(), re.DOTALL)
    with ExitStack() as stack:
        networks = Namespaces(["router", "strangers"], stack)
        host = networks.address("router")
        fleet = make_fleet(tmp_path, (host,), alice="drive")
        port = port_of(fleet)
        load = [*networks.within("router"), "nft", "-f", "-"]
        subprocess.run(load, input=rules.replace("7447", str(port)), text=True, check=True)
        router = RouterProcess(fleet, stack, within=networks.within("router"))

        def descriptors() -> int:
            return len(list(Path(f"/proc/{router.process.pid}/fd").iterdir()))

        assert gets_in(fleet)
        before = descriptors()
        with strangers(1150, host, port, networks.within("strangers")):
            wait_until(lambda: descriptors() >= before + 15)
            deadline = time.monotonic() + 12.0  # the silent ones fail after 10 s
            while time.monotonic() < deadline:
                assert descriptors() <= before + 30
                wait_until(lambda: gets_in(fleet))
        wait_until(lambda: gets_in(fleet), within=PATIENCE)
        assert router.process.poll() is None
