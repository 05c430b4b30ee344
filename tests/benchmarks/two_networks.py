"""Two networks between a ground station and a vehicle, in namespaces of Linux: one direct, one through a relay.

nftables cuts a network or loses packets of it. The kernel's netem is not everywhere, so that the relay of
lossy_relay.py, in a namespace of its own, delays and reorders. Frozen, it keeps what comes, as a buffer does.
"""

from __future__ import annotations

import os
import subprocess
from contextlib import ExitStack

from tests.e2e.namespaces import why_not as why_no_namespaces

DIRECT, RELAYED = "direct", "relayed"
GROUND_PORTS = {DIRECT: 14550, RELAYED: 14551}
RELAY_PORT = 14552

why_not = why_no_namespaces


class TwoNetworks:
    """Namespaces of the ground station, the vehicle and the relay. Addresses of the ground station end with 1."""

    def __init__(self, stack: ExitStack) -> None:
        self._tag = f"two{os.getpid() % 100000}"
        self._net = f"10.{50 + os.getpid() % 40}"
        self._stack = stack
        for name in ("ground", "vehicle", "relay"):
            self._run("ip", "netns", "add", self._name(name))
            stack.callback(self._run, "ip", "netns", "del", self._name(name))
            self._ip(name, "link", "set", "lo", "up")
        self._cable(1, "ground", "vehicle")
        self._cable(2, "ground", "relay")
        self._cable(3, "relay", "vehicle")

    def within(self, name: str) -> tuple[str, ...]:
        """Return the command in front of one that shall run in a namespace."""
        return "ip", "netns", "exec", self._name(name)

    @property
    def ground_endpoints(self) -> tuple[str, ...]:
        """Return the endpoints of the ground station, that of the direct network first."""
        return f"udpin:{self._net}.1.1:{GROUND_PORTS[DIRECT]}", f"udpin:{self._net}.2.1:{GROUND_PORTS[RELAYED]}"

    @property
    def vehicle_endpoints(self) -> tuple[str, ...]:
        """Return the endpoints of the vehicle in the same order."""
        return f"udpout:{self._net}.1.1:{GROUND_PORTS[DIRECT]}", f"udpout:{self._net}.3.1:{RELAY_PORT}"

    @property
    def relay_ends(self) -> tuple[str, str]:
        """Return where the relay listens for the vehicle, and where the ground station is."""
        return f"{self._net}.3.1:{RELAY_PORT}", f"{self._net}.2.1:{GROUND_PORTS[RELAYED]}"

    def lose(self, network: str, percent: int) -> None:
        """Drop so many of the packets of a network from now on, both ways and at random; 100 cuts it."""
        self.mend(network)
        cable = self._vehicle_cable(network)
        chance = "" if percent >= 100 else f"numgen random mod 100 < {percent} "
        chains = "".join(
            f"chain {hook} {{ type filter hook {hook} priority 0; {way} {cable} {chance}drop; }}\n"
            for hook, way in (("input", "iifname"), ("output", "oifname"))
        )
        self._run(*self.within("vehicle"), "nft", f"table inet {network} {{ {chains} }}")

    def mend(self, network: str) -> None:
        """Let all packets of a network pass."""
        delete = (*self.within("vehicle"), "nft", f"delete table inet {network}")
        subprocess.run(delete, check=False, capture_output=True)

    def _vehicle_cable(self, network: str) -> str:
        return f"{self._tag}{'1' if network == DIRECT else '3'}b"

    def _name(self, name: str) -> str:
        return f"{self._tag}-{name}"

    def _cable(self, number: int, first: str, second: str) -> None:
        near, far = f"{self._tag}{number}a", f"{self._tag}{number}b"
        self._run("ip", "link", "add", near, "netns", self._name(first), "type", "veth",
                  "peer", "name", far, "netns", self._name(second))  # fmt: skip
        for name, cable, last in ((first, near, 1), (second, far, 2)):
            self._ip(name, "addr", "add", f"{self._net}.{number}.{last}/24", "dev", cable)
            self._ip(name, "link", "set", cable, "up")

    def _ip(self, name: str, *words: str) -> None:
        self._run("ip", "-n", self._name(name), *words)

    @staticmethod
    def _run(*command: str) -> None:
        subprocess.run(command, check=True, capture_output=True, text=True)
