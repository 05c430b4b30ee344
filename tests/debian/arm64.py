"""The package for arm64, unpacked into a Debian for arm64 and run by QEMU: python3 -m tests.debian FILE_arm64.deb.

QEMU translates the instructions of one process, so programs run and modules are imported; maintainer scripts, which
start programs of that machine, do not run.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from tests.debian.steps import StepError

EMULATOR = "qemu-aarch64-static"
IMPORTS = """
import importlib, platform, sys
for name in sys.argv[1].split():
    importlib.import_module(name)
print(platform.machine(), platform.python_version(), len(sys.modules))
"""
COMPILED = "aiohttp apsw fastcrc lz4.frame msgspec multidict sdl2 xxhash zenoh zeroconf zstandard"
"""Modules of wheels with code for the processor."""
OURS = "dialects.rover vehicle.runtime.daemon groundstation.station.process groundstation.ui.app link.transport.serial"
"""What a vehicle and a ground station import when they run."""


def unpack_and_run(package: Path, suite: str, folder: Path, cache: Path) -> str:
    """Unpack the package, import what its programs import, run one; return what was seen. Raises StepError."""
    if shutil.which(EMULATOR) is None:
        raise StepError(f"{EMULATOR} is missing: apt-get install --no-install-recommends qemu-user-static")
    root = folder / "root"
    subprocess.run(["cp", "-a", "--reflink=auto", str(_system(suite, cache)), str(root)], check=True)
    subprocess.run(["dpkg-deb", "--extract", str(package), str(root)], check=True)
    seen = _run(root, "/usr/lib/mavhelm/bin/python3", "-c", IMPORTS, f"{COMPILED} {OURS}")
    if not seen.startswith("aarch64 "):
        raise StepError(f"that is another processor: {seen}")
    version = _run(root, "/usr/lib/mavhelm/bin/python3", "/usr/bin/vehicle", "--version")
    return f"{seen} modules, {version}"


def _system(suite: str, cache: Path) -> Path:
    """Return a Debian for arm64 with Python, unpacked and not configured; made if it is not there yet."""
    kept = cache / f"{suite}-arm64"
    if not kept.exists():
        partly = cache / f"{suite}-arm64.partly"
        shutil.rmtree(partly, ignore_errors=True)
        options = ("--foreign", "--arch=arm64", "--variant=minbase", "--include=python3,libstdc++6")
        subprocess.run(["debootstrap", *options, suite, str(partly)], check=True, stdout=subprocess.DEVNULL)
        for each in sorted((partly / "var/cache/apt/archives").glob("*.deb")):
            subprocess.run(["dpkg-deb", "--extract", str(each), str(partly)], check=True)
        partly.rename(kept)
    return kept


def _run(root: Path, *command: str) -> str:
    """Run a program of that system; return its output. Its loader finds the program's own files in the root."""
    emulator = root / EMULATOR
    if not emulator.exists():
        shutil.copy(str(shutil.which(EMULATOR)), emulator)
    environment = {"PATH": "/usr/bin:/bin", "LC_ALL": "C.UTF-8", "PYTHONDONTWRITEBYTECODE": "1", "HOME": "/"}
    words = ["/usr/sbin/chroot", str(root), f"/{EMULATOR}", *command]
    done = subprocess.run(words, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    if done.returncode:
        raise StepError(f"{' '.join(command)[:80]}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout.strip().splitlines()[-1]
