"""The files of an arm64 system: Debian's packages of Python, unpacked but not installed, and wheels from PyPI."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

ARCHITECTURE, DEBIAN = "aarch64", "arm64"
EMULATOR = "qemu-aarch64-static"
PROGRAMS = (EMULATOR, "apt-get", "dpkg-deb")
PACKAGE = "python3.11"
PLATFORMS = ("manylinux_2_28_aarch64", "manylinux_2_17_aarch64", "manylinux2014_aarch64")
WHEELS = (
    "pymavlink", "fastcrc", "pyserial", "textual", "platformdirs", "msgspec",
    "pytest", "pytest-asyncio", "pytest-timeout", "hypothesis", "gpiozero", "smbus2",
)  # fmt: skip


class MissingError(Exception):
    """There is no emulation here; the text says what to install, or what failed."""


@dataclass(frozen=True, slots=True)
class Root:
    """An unpacked system."""

    folder: Path
    site: Path
    """Folder of the wheels."""

    @property
    def python(self) -> tuple[str, ...]:
        """Return the command that runs its Python."""
        return EMULATOR, "-L", str(self.folder), str(self.folder / "usr/bin" / PACKAGE)


def prepare(folder: Path, constraints: Path) -> Root:
    """Fetch packages and wheels into `folder`, unless they are there. Needs no root. Raises MissingError."""
    if not all(map(shutil.which, PROGRAMS)):
        raise MissingError("install first: apt-get install --no-install-recommends qemu-user-static (on Debian)")
    root = Root(folder / "root", folder / "site")
    if not root.folder.exists():
        _unpack(folder, _fetch(folder / "apt"))
    if not root.site.exists():
        _install(root.site, constraints)
    return root


def _fetch(apt: Path) -> Sequence[Path]:
    """Download the package and all that it depends on, with lists of packages of their own."""
    for name in ("lists/partial", "archives/partial"):
        (apt / name).mkdir(parents=True, exist_ok=True)
    (apt / "status").touch()
    settings = {
        "APT::Architecture": DEBIAN,
        "APT::Architectures::": DEBIAN,
        "Dir::State": apt,
        "Dir::State::Lists": apt / "lists",
        "Dir::State::status": apt / "status",
        "Dir::Cache": apt,
        "Dir::Cache::Archives": apt / "archives",
        "APT::Sandbox::User": "",
        "Debug::NoLocking": "1",
    }
    words = [word for name, value in settings.items() for word in ("-o", f"{name}={value}")]
    _run("apt-get", *words, "-q", "update")
    _run("apt-get", *words, "-q", "-y", "install", "--download-only", "--no-install-recommends", PACKAGE)
    return sorted((apt / "archives").glob("*.deb"))


def _unpack(folder: Path, packages: Sequence[Path]) -> None:
    unfinished = folder / "unfinished"
    for package in packages:
        _run("dpkg-deb", "--extract", str(package), str(unfinished))
    unfinished.rename(folder / "root")


def _install(site: Path, constraints: Path) -> None:
    unfinished = site.with_name("unfinished-site")
    shutil.rmtree(unfinished, ignore_errors=True)
    platforms = [word for platform in PLATFORMS for word in ("--platform", platform)]
    target = (
        "--python-version",
        "3.11",
        "--implementation",
        "cp",
        "--only-binary",
        ":all:",
        "--target",
        str(unfinished),
    )
    _run(sys.executable, "-m", "pip", "install", "-q", "-c", str(constraints), *platforms, *target, *WHEELS)
    unfinished.rename(site)


def _run(*command: str) -> None:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        last = (done.stderr or done.stdout).strip().splitlines()[-1:]
        raise MissingError(f"{' '.join(command[:2])}: {''.join(last) or f'exit code {done.returncode}'}")
