"""Networks of one test: namespaces of Linux with a cable each to a switch, which nftables can cut. Needs root."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

HERE = 1
"""Last number of the address of this process; namespaces have the next ones."""


def why_not() -> str | None:
    """Return why there can be no namespaces here; None: there can."""
    if os.geteuid() != 0:
        return "network namespaces need root"
    missing = [name for name in ("ip", "nft") if shutil.which(name) is None]
    if missing:
        return f"network namespaces need the program {missing[0]}"
    with ExitStack() as stack:
        try:
            Namespaces(["try"], stack)
        except subprocess.CalledProcessError as error:
            return f"no network namespaces here: {' '.join(error.stderr.split())}"
    return None


class Namespaces:
    """One namespace for each name, and one with the switch. This process has a cable too."""

    def __init__(self, names: list[str], stack: ExitStack) -> None:
        self._tag = f"t{os.getpid() % 100000}"
        self._net = f"10.{100 + os.getpid() % 100}.{os.getpid() // 100 % 250}"
        self._names = names
        self._switch = f"{self._tag}-switch"
        self._add(self._switch, stack)
        _ip("-n", self._switch, "link", "add", "switch", "type", "bridge")
        _ip("-n", self._switch, "link", "set", "switch", "up")
        self._cable(f"{self._tag}here", None, HERE, stack)
        for number, name in enumerate(names, HERE + 1):
            self._add(f"{self._tag}-{name}", stack)
            self._cable(f"{self._tag}{number}", f"{self._tag}-{name}", number, stack)

    @property
    def here(self) -> str:
        """Return the address of this process."""
        return f"{self._net}.{HERE}"

    def address(self, name: str) -> str:
        """Return the address of a namespace."""
        return f"{self._net}.{HERE + 1 + self._names.index(name)}"

    def within(self, name: str) -> tuple[str, ...]:
        """Return the command in front of one that shall run in a namespace."""
        return "ip", "netns", "exec", f"{self._tag}-{name}"

    @contextmanager
    def cut(self, name: str) -> Iterator[None]:
        """Drop all packets from and to a namespace for a while; nobody is told."""
        rules = "".join(
            f"chain {hook} {{ type filter hook {hook} priority 0; oifname != lo drop; }}\n"
            if hook == "output"
            else f"chain {hook} {{ type filter hook {hook} priority 0; iifname != lo drop; }}\n"
            for hook in ("input", "output")
        )
        _run(*self.within(name), "nft", f"table inet cut {{ {rules} }}")
        try:
            yield
        finally:
            _run(*self.within(name), "nft", "delete table inet cut")

    def _add(self, name: str, stack: ExitStack) -> None:
        _ip("netns", "add", name)
        stack.callback(_ip, "netns", "del", name)
        _ip("-n", name, "link", "set", "lo", "up")

    def _cable(self, cable: str, namespace: str | None, number: int, stack: ExitStack) -> None:
        """Lay a cable from the switch to a namespace, or to this process."""
        _ip("link", "add", cable, "type", "veth", "peer", "name", f"{cable}s")
        stack.callback(subprocess.run, ["ip", "link", "del", cable], capture_output=True, check=False)
        _ip("link", "set", f"{cable}s", "netns", self._switch)
        _ip("-n", self._switch, "link", "set", f"{cable}s", "master", "switch", "up")
        there = () if namespace is None else ("-n", namespace)
        if namespace is not None:
            _ip("link", "set", cable, "netns", namespace)
        _ip(*there, "addr", "add", f"{self._net}.{number}/24", "dev", cable)
        _ip(*there, "link", "set", cable, "up")


def _ip(*words: str) -> None:
    _run("ip", *words)


def _run(*command: str) -> None:
    subprocess.run(command, check=True, capture_output=True, text=True)
