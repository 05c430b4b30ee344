"""Write the manual pages into a folder: `python -m manpages FOLDER`. SOURCE_DATE_EPOCH sets their date."""

from __future__ import annotations

import os
import sys
import time
from importlib.metadata import version
from pathlib import Path

from manpages.pages import SHORT_NAMES, build_pages
from manpages.roff import Edition, build


def main(folder: Path) -> int:
    """Write NAME.1 for every page; return the exit code."""
    seconds = float(os.environ.get("SOURCE_DATE_EPOCH", time.time()))
    edition = Edition(version("mavhelm"), time.strftime("%Y-%m-%d", time.gmtime(seconds)))
    os.environ["COLUMNS"] = "10000"  # argparse breaks lines at the width of the terminal; a page is filled by man
    folder.mkdir(parents=True, exist_ok=True)
    for page in build_pages():
        (folder / f"{page.name}.1").write_text(build(page, edition), "utf-8")
    for name, shown in SHORT_NAMES.items():
        (folder / f"{name}.1").write_text(f".so man1/{shown}.1\n")
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python -m manpages FOLDER")
    sys.exit(main(Path(sys.argv[1])))
