"""Assemble the Debian package from wheels: make deb; ARGS="--arch arm64 --suite bookworm"."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from deb.target import MACHINES, SUITES, DebTarget
from deb.tree import Build, lay_out, pack
from deb.wheels import MissingWheelError, gather, wheels_in

ROOT = Path(__file__).resolve().parents[2]


def main(words: list[str]) -> int:
    """Build the packages; return the exit code."""
    options = _parser().parse_args(words)
    time = int(os.environ.get("SOURCE_DATE_EPOCH") or _git_time())
    options.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="mavhelm-deb-") as scratch:
        wheel = options.wheel or _build_wheel(Path(scratch), time)
        for architecture in options.arch or MACHINES:
            target = DebTarget(options.suite, architecture)
            cache = options.cache / f"{options.suite}-{architecture}"
            cache.mkdir(parents=True, exist_ok=True)
            try:
                bundled = gather(wheel, target, cache, ROOT / "constraints.txt")
            except MissingWheelError as error:
                print(f"deb: {error}", file=sys.stderr)
                return 1
            build = Build(target, wheel, bundled, options.revision, time)
            root = Path(scratch) / architecture / "root"
            lay_out(build, root, ROOT)
            print(pack(root, options.out, build), flush=True)
    return 0


def _git_time() -> str:
    return subprocess.run(
        ["git", "log", "-1", "--format=%ct"], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout


def _build_wheel(folder: Path, time: int) -> Path:
    """Build mavhelm's wheel with the build backend of this Python (extra `dev`)."""
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder / "wheel")]
    environment = {**os.environ, "SOURCE_DATE_EPOCH": str(time)}
    subprocess.run(command, cwd=ROOT, check=True, env=environment, stdout=subprocess.DEVNULL)
    [wheel] = wheels_in(folder / "wheel").values()
    return wheel


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m deb", description=__doc__)
    parser.add_argument("--arch", action="append", choices=MACHINES, help="processor; repeatable (default: all)")
    parser.add_argument("--suite", choices=SUITES, default="trixie", help="release of Debian (default: %(default)s)")
    parser.add_argument("--revision", type=int, default=1, help="of the package (default: %(default)s)")
    parser.add_argument("--wheel", type=Path, metavar="FILE", help="wheel of mavhelm (default: built from this tree)")
    parser.add_argument("--out", type=Path, default=ROOT / "dist", metavar="FOLDER", help="default: %(default)s")
    parser.add_argument(
        "--cache", type=Path, default=Path("/var/tmp/mavhelm-wheels"), metavar="FOLDER",
        help="keeps the wheels that pip has fetched (default: %(default)s)",
    )  # fmt: skip
    return parser


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
