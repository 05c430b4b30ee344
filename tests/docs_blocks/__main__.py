"""`python -m tests.docs_blocks docs/PAGE.md`: run the shell blocks of a page, in namespaces of its own."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.docs_blocks.forked_verbs import forked_verbs
from tests.docs_blocks.machine import ROOT, Machines, why_not, within
from tests.docs_blocks.page import Page

INSIDE = "MAVHELM_DOCS_BLOCKS"


def main(path: Path) -> int:
    """Return 0 if all of them did what the page says."""
    if INSIDE in os.environ:
        machines = Machines(Path(os.environ[INSIDE]))
        page = Page(path, machines)
        with forked_verbs(path, machines.programs):
            page.type_all()
        print(*page.faults, sep="\n")
        print(f"{path.name}: {page.ran} blocks run, {page.explained} explained, {len(page.faults)} faults")
        return 1 if page.faults else 0
    if reason := why_not():
        print(reason)
        return 2
    with tempfile.TemporaryDirectory(prefix="mavhelm-docs-") as folder:
        command = within(sys.executable, "-m", "tests.docs_blocks", str(path))
        return subprocess.run(command, env={**os.environ, INSIDE: folder}, cwd=ROOT).returncode


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m tests.docs_blocks", description=(__doc__ or "").partition(": ")[2])
    parser.add_argument("page", type=Path, metavar="PAGE.md")
    named: Path = parser.parse_args().page
    if not named.is_file():
        parser.error(f"{named}: no such file")
    sys.exit(main(named))
