"""`python3 -m tests.stranger`: type README's lines in a fresh clone, with an empty environment, and see them work.

With `--bare SUITE` in a bare Debian of that suite, from its package list to the tests; that needs root and debootstrap.
Only the standard library is used: nothing of the project is installed yet where this runs.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from contextlib import closing
from pathlib import Path

from tests.docs_blocks.markdown import find_blocks
from tests.docs_blocks.terminal import LineError
from tests.stranger.computers import BareDebian, Computer, ThisComputer, namespaces
from tests.stranger.reader import Reader

ROOT = Path(__file__).parents[2]
INSIDE = "MAVHELM_STRANGER"
"""Set to the folder for a bare Debian, in the process that has mounts of its own."""


def main(argv: list[str] | None = None) -> int:
    """Return 0 if every line did what README says."""
    words = sys.argv[1:] if argv is None else argv
    asked = _parser().parse_args(words)
    settings = dict(each.split("=", 1) for each in asked.env)
    if INSIDE in os.environ:
        return _read_readme(
            BareDebian(Path(os.environ[INSIDE]), ROOT, settings, asked.bare, asked.cache), asked.no_skips
        )
    with tempfile.TemporaryDirectory(prefix="mavhelm-stranger-") as folder:
        if not asked.bare:
            return _read_readme(ThisComputer(Path(folder), ROOT, settings), asked.no_skips)
        # What is mounted there ends with that process: the folder is removed by this one, which never sees /dev in it.
        command = [*namespaces(), sys.executable, "-m", "tests.stranger", *words]
        return subprocess.run(command, env={**os.environ, INSIDE: folder}, cwd=ROOT).returncode


def _read_readme(computer: Computer, no_skips: bool) -> int:
    began = time.monotonic()
    reader = Reader(computer, no_skips)
    try:
        with closing(reader):
            for block in find_blocks((ROOT / "README.md").read_text()):
                reader.type_block(block)
            reader.collect_all()
    except LineError as failed:
        print(f"README.md: {failed}", file=sys.stderr)
        return 1
    print(f"README.md: {reader.typed} lines typed on {computer.name}, all work; {time.monotonic() - began:.0f} s")
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python3 -m tests.stranger", description=__doc__)
    parser.add_argument("--bare", metavar="SUITE", help="a bare Debian: trixie, bookworm")
    parser.add_argument("--env", metavar="NAME=VALUE", action="append", default=[], help="one variable; repeatable")
    parser.add_argument("--no-skips", action="store_true", help="fail if a test was skipped")
    parser.add_argument(
        "--cache", type=Path, default=Path("/var/cache/mavhelm/bare"), metavar="FOLDER",
        help="keeps what debootstrap has made (default: %(default)s)",
    )  # fmt: skip
    return parser


if __name__ == "__main__":
    sys.exit(main())
