"""Install, start, upgrade and purge the Debian package in a bare Debian: make deb-check. Needs root and debootstrap.

A package for arm64 is unpacked and imported under QEMU.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.debian import arm64, steps
from tests.stranger.computers import namespaces

ROOT = Path(__file__).resolve().parents[2]
INSIDE = "MAVHELM_DEBIAN"
"""Set to the folder for a bare Debian, in the process that has mounts of its own."""


def main(words: list[str]) -> int:
    """Return 0 if every step did what it must."""
    options = _parser().parse_args(words)
    if INSIDE in os.environ:
        return _run(options, Path(os.environ[INSIDE]))
    with tempfile.TemporaryDirectory(prefix="mavhelm-debian-") as folder:
        command = [*namespaces(), sys.executable, "-m", "tests.debian", *words]
        return subprocess.run(command, env={**os.environ, INSIDE: folder}, cwd=ROOT, check=False).returncode


def _run(options: argparse.Namespace, folder: Path) -> int:
    package = options.package.absolute()
    if package.stem.endswith("_arm64"):
        return _run_emulated(options, package, folder)
    settings = dict(each.split("=", 1) for each in options.env)
    machine = steps.Machine(folder, ROOT, settings, options.suite, options.cache)
    newer = steps.make_newer(package, folder)
    try:
        steps.timed("install", lambda: steps.install(machine, package))
        steps.timed("start", lambda: steps.start(machine))
        steps.timed("extra", lambda: steps.add_extra(machine))
        steps.timed("upgrade", lambda: steps.upgrade(machine, newer))
        steps.timed("purge", lambda: steps.purge(machine))
    except steps.StepError as failed:
        print(f"{package.name}: {failed}", file=sys.stderr)
        return 1
    print(f"{package.name}: installed, started, upgraded and purged on {machine.name}")
    return 0


def _run_emulated(options: argparse.Namespace, package: Path, folder: Path) -> int:
    try:
        seen = arm64.unpack_and_run(package, options.suite, folder, options.cache)
    except steps.StepError as failed:
        print(f"{package.name}: {failed}", file=sys.stderr)
        return 1
    print(f"{package.name}: unpacked and imported: {seen}")
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python3 -m tests.debian", description=__doc__)
    parser.add_argument("package", type=Path, metavar="FILE.deb")
    parser.add_argument("--suite", default="trixie", help="release of Debian (default: %(default)s)")
    parser.add_argument("--env", metavar="NAME=VALUE", action="append", default=[], help="one variable; repeatable")
    parser.add_argument(
        "--cache", type=Path, default=Path("/var/cache/mavhelm/bare"), metavar="FOLDER",
        help="keeps what debootstrap has made (default: %(default)s)",
    )  # fmt: skip
    return parser


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
