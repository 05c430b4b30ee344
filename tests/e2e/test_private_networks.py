"""A modem, a tunnel and a local network of one rover: who drives it without a key. Needs root, and tun devices."""

from __future__ import annotations

import fcntl
import os
import select
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.e2e.namespaces import Namespaces, why_not
from tests.e2e.programs import Vehicle
from tests.waits import PATIENCE

REASON = why_not() or (None if Path("/dev/net/tun").exists() else "no tun devices here")
pytestmark = [pytest.mark.e2e, pytest.mark.skipif(REASON is not None, reason=str(REASON))]

TUNSETIFF, IFF_TUN, IFF_NO_PI = 0x400454CA, 1, 0x1000
ROVER, OTHER, PORT = "10.8.0.2", "10.8.0.1", 14550
DRIVES, DENIED, NO_VEHICLE = 0, 4, 3
"""Exit codes of `mavhelm arm`."""


class Tunnel:
    """A tun device (kind 65534) in each of two namespaces; what goes into one comes out of the other."""

    def __init__(self, networks: Namespaces, name: str, stack: ExitStack) -> None:
        self._networks, self._name = networks, name
        self._ends: list[int] = []
        self._lock = threading.Lock()
        self.connect()
        copying = threading.Thread(target=self._copy, daemon=True)
        copying.start()
        stack.callback(self.close)

    def connect(self) -> None:
        """Make both devices, again if they exist: as a tunnel that was restarted."""
        with self._lock:
            self._drop()
            for namespace, address in (("rover", ROVER), ("other", OTHER)):
                self._ends.append(os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK))
                temporary = f"t{os.getpid() % 100000}{namespace[0]}"
                fcntl.ioctl(self._ends[-1], TUNSETIFF, struct.pack("16sH", temporary.encode(), IFF_TUN | IFF_NO_PI))
                within = self._networks.within(namespace)
                _run("ip", "link", "set", temporary, "netns", within[-1], "name", self._name)
                _run(*within, "ip", "addr", "add", f"{address}/24", "dev", self._name)
                _run(*within, "ip", "link", "set", self._name, "up")

    def close(self) -> None:
        """Remove both."""
        with self._lock:
            self._drop()
            self._networks = None  # type: ignore[assignment]

    def _drop(self) -> None:
        for end in self._ends:
            os.close(end)
        self._ends = []

    def _copy(self) -> None:
        while self._networks is not None:
            with self._lock:
                ends = self._ends[:]
                for end in select.select(ends, [], [], 0.005)[0]:
                    try:
                        os.write(ends[1 - ends.index(end)], os.read(end, 65536))
                    except OSError:  # the other end is down
                        continue
            time.sleep(0)


class Rover:
    """A simulated rover at its address in the tunnel, and those who try to arm it without a key."""

    def __init__(self, folder: Path, interface: str, stack: ExitStack) -> None:
        self._folder, self._stack = folder, stack
        self.networks = Namespaces(["rover", "other", "stranger"], stack)
        self.tunnel = Tunnel(self.networks, interface, stack)
        # Linux has a way to the rover's address in the tunnel by the network that both are in.
        _run(*self.networks.within("stranger"), "ip", "route", "add", ROVER, "via", self.networks.address("rover"))

    def start(self, endpoint: str, signing: str, said: str = "ready") -> Vehicle:
        """Start it, and return when it is ready and has `said` something."""
        config = self._folder / "rover.toml"
        config.write_text(f"[motors]\ndriver = 'simulated'\n[signing]\n{signing}\n")
        vehicle = Vehicle(self._folder, endpoint, "--config", str(config), within=self.networks.within("rover"))
        self._stack.callback(vehicle.end)
        until = time.monotonic() + PATIENCE
        while said not in vehicle.errors.read_text():
            assert vehicle.process.poll() is None, vehicle.errors.read_text()
            assert time.monotonic() < until, vehicle.errors.read_text()
            os.sched_yield()
        return vehicle

    def arm(self, who: str, endpoint: str = f"udpout:{ROVER}:{PORT}") -> int:
        """Return the exit code of `mavhelm arm` of somebody."""
        command = (*self.networks.within(who), sys.executable, "-m", "groundstation", "arm", "--wait", "8")
        return subprocess.run([*command, "--station", "never", "-e", endpoint]).returncode


@pytest.fixture
def rover(tmp_path: Path) -> Iterator[Callable[[str], Rover]]:
    with ExitStack() as stack:
        yield lambda interface: Rover(tmp_path, interface, stack)


@pytest.mark.parametrize("interface", ["wwan0", "ppp0", "tun0"])
def test_nobody_behind_a_modem_drives_without_a_key(rover: Callable[[str], Rover], interface: str) -> None:
    made = rover(interface)
    vehicle = made.start(f"udpin:{ROVER}:{PORT}", "")
    assert "nobody may drive" in vehicle.errors.read_text()
    assert made.arm("other") == DENIED


def test_a_modem_to_which_the_rover_sends_is_no_tunnel(rover: Callable[[str], Rover]) -> None:
    made = rover("wwan0")
    vehicle = made.start(f"udpout:{OTHER}:{PORT}", "")
    assert "nobody may drive" in vehicle.errors.read_text()
    assert made.arm("other", f"udpin:{OTHER}:{PORT}") == DENIED


@pytest.mark.parametrize("scheme", ["udp", "tcp"])
def test_only_who_is_inside_a_named_tunnel_drives_without_a_key(rover: Callable[[str], Rover], scheme: str) -> None:
    """The local network reaches the tunnel's address, and not the socket that is bound to the tunnel."""
    made = rover("wg0")
    vehicle = made.start(f"{scheme}in:{ROVER}:{PORT}", 'private = ["wg0", "wg9"]', "no interface wg9 now")
    said = vehicle.errors.read_text()
    assert f"{scheme}in:{ROVER}:{PORT}: needs no key, wg0 is named in private under [signing]" in said
    reach = f"{scheme}out:{ROVER}:{PORT}"
    assert made.arm("stranger", reach) == NO_VEHICLE
    assert made.arm("other", reach) == DRIVES


def test_a_tunnel_that_was_restarted_is_used_again(rover: Callable[[str], Rover]) -> None:
    made = rover("wg0")
    made.start(f"udpin:{ROVER}:{PORT}", 'private = ["wg0"]')
    made.tunnel.connect()
    assert made.arm("other") == DRIVES
    assert made.arm("stranger") == NO_VEHICLE


def _run(*command: str) -> None:
    subprocess.run(command, check=True, capture_output=True, text=True)
