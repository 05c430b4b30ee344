"""What an administrator does with the package, and what must then be so."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.stranger.computers import BareDebian

CONFIG = "/etc/mavhelm/rover.toml"
MINE = "# mine\n"
APT = ("apt-get", "-qy", "-o", "Dpkg::Use-Pty=0", "-o", "Acquire::Retries=5")
VEHICLE = ("setpriv", "--reuid=mavhelm", "--regid=mavhelm", "--init-groups")
ENDPOINT = "udpout:127.0.0.1:14550"
START = 60.0
"""s within which the vehicle must answer."""


class StepError(Exception):
    """A step did not do what it must; the text has its output."""


class Machine(BareDebian):
    """A bare Debian in which programs run as root."""

    @property
    def root(self) -> Path:
        """Return its folder."""
        return self._root

    def run(self, *command: str, code: int = 0) -> str:
        """Run a program; return its output. Raises StepError for another exit code."""
        done = subprocess.run(
            self.inside(*command), stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False
        )
        if done.returncode != code:
            raise StepError(f"{' '.join(command)}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
        return done.stdout + done.stderr

    def inside(self, *command: str) -> list[str]:
        """Return the command that runs another one in it, with root's environment."""
        path = "PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"
        settings = ("HOME=/root", path, "LC_ALL=C.UTF-8", "DEBIAN_FRONTEND=noninteractive", *self.pairs)
        return ["/usr/sbin/chroot", str(self._root), "/usr/bin/env", "-i", *settings, *command]

    @property
    def pairs(self) -> list[str]:
        """Return the settings that the command line gave."""
        return [f"{name}={value}" for name, value in self._settings.items()]


def check(true: bool, text: str) -> None:
    """Raise StepError if something is not so."""
    if not true:
        raise StepError(text)


def install(machine: Machine, package: Path) -> None:
    """Install the package with what it depends on: its programs run, and nothing is started or enabled."""
    _bring(machine, package)
    machine.run(*APT, "update")
    machine.run(*APT, "install", "--no-install-recommends", f"/srv/{package.name}")
    for program in ("mavhelm", "groundstation", "vehicle"):
        machine.run(program, "--version")
    machine.run("sh", "-c", "command -v bridge", code=127)
    check((machine.root / "usr/lib/mavhelm/bin/bridge").exists(), "the private bridge is missing")
    groups = machine.run("id", "-Gn", "mavhelm").split()
    check(set(groups) == {"mavhelm", "dialout", "gpio", "i2c", "video"}, f"groups: {groups}")
    enabled = list((machine.root / "etc/systemd/system").rglob("rover.service"))
    check(not enabled, f"the service is enabled: {enabled}")
    machine.run("systemd-analyze", "verify", "/usr/lib/systemd/system/rover.service")
    compiled = list((machine.root / "usr/lib/mavhelm").rglob("*.pyc"))
    check(len(compiled) > 500, f"{len(compiled)} modules are compiled")


@contextmanager
def started(machine: Machine) -> Iterator[None]:
    """Run the vehicle as its service does: with the program, the file and the user of the unit."""
    unit = (machine.root / "usr/lib/systemd/system/rover.service").read_text()
    [command] = [line.partition("=")[2].split() for line in unit.splitlines() if line.startswith("ExecStart=")]
    running = subprocess.Popen(machine.inside(*VEHICLE, *command), stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    try:
        yield
    finally:
        running.terminate()
        output, _ = running.communicate(timeout=60)
    check(running.returncode == 0, f"the vehicle ended with {running.returncode}\n{output.decode()}")


def start(machine: Machine) -> None:
    """Start the vehicle: it passes its own check, and a ground station sees it."""
    machine.run(*VEHICLE, "vehicle", "check", CONFIG)
    with started(machine):
        status = machine.run("groundstation", "status", "-e", ENDPOINT, "--wait", f"{START:g}")
        check("MANUAL" in status or "HOLD" in status, status)
    owner = machine.run("stat", "-c", "%U %a", "/var/lib/mavhelm").strip()
    check(owner == "mavhelm 700", f"/var/lib/mavhelm: {owner}")


def add_extra(machine: Machine) -> None:
    """Do what the message about a missing extra says, and see it work."""
    log = "/root/drive.tlog"
    export = ("groundstation", "export", log, "--mcap", "/root/drive.mcap")
    with started(machine):
        machine.run("groundstation", "status", "-e", ENDPOINT, "--wait", f"{START:g}")
        machine.run("groundstation", "record", log, "--for", "2", "-e", ENDPOINT)
    refused = machine.run(*export, code=2)
    command = refused.strip().rpartition(": sudo ")[2].split()
    check(command[:2] == ["apt", "install"], f"no command of apt: {refused}")
    machine.run(*command, "-y")
    machine.run(*export)
    check((machine.root / "root/drive.mcap").stat().st_size > 1000, "the MCAP file is empty")


def upgrade(machine: Machine, newer: Path) -> None:
    """Upgrade with a file of settings that both sides have changed: the administrator's stays."""
    file = machine.root / CONFIG[1:]
    file.write_text(MINE + file.read_text())
    _bring(machine, newer)
    machine.run(*APT, "-o", "Dpkg::Options::=--force-confold", "install", f"/srv/{newer.name}")
    check(file.read_text().startswith(MINE), "an upgrade has overwritten rover.toml")
    check(file.with_name("rover.toml.dpkg-dist").exists(), "the new rover.toml was not kept beside it")
    start(machine)


def purge(machine: Machine) -> None:
    """Purge the package: no file of it is left."""
    machine.run(*APT, "purge", "mavhelm")
    places = ("etc/mavhelm", "usr/lib/mavhelm", "var/lib/mavhelm", "usr/lib/systemd/system/rover.service")
    left = [place for place in places if (machine.root / place).exists()]
    check(not left, f"left behind: {left}")
    machine.run("dpkg", "--status", "mavhelm", code=1)


def make_newer(package: Path, folder: Path) -> Path:
    """Return a package of a later version, whose rover.toml has changed. It is not compressed."""
    tree = folder / "newer"
    subprocess.run(["dpkg-deb", "--raw-extract", str(package), str(tree)], check=True)
    control = tree / "DEBIAN/control"
    text = control.read_text()
    control.write_text(text.replace("\nVersion: ", "\nVersion: 1:", 1))
    config = tree / CONFIG[1:]
    config.write_text(config.read_text() + "\n# a line of the newer version\n")
    newer = folder / package.name.replace("mavhelm_", "mavhelm_newer_")
    command = ["dpkg-deb", "--root-owner-group", "-Znone", "--build", str(tree), str(newer)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return newer


def _bring(machine: Machine, package: Path) -> None:
    target = machine.root / "srv" / package.name
    target.write_bytes(package.read_bytes())


def timed(name: str, step: Callable[[], None]) -> None:
    """Do a step and print how long it took."""
    began = time.monotonic()
    step()
    print(f"{name}: done, {time.monotonic() - began:.0f} s", flush=True)
