"""Pictures for the documents: the real app, station and simulators, and what they show after a while.

python -m tests.groundstation.ui.screenshots docs           writes docs/drive_80x24.png, docs/map_80x24.png ...
python -m tests.groundstation.ui.screenshots docs links     takes those of one group again

rsvg-convert (Debian: librsvg2-bin, with fonts-jetbrains-mono) makes the PNG files; without it
there are SVG files. The ports 14550 and 14551 of this machine must be free.
"""

from __future__ import annotations

import argparse
import asyncio
import os
import shutil
import subprocess
from collections.abc import Awaitable, Callable
from pathlib import Path

from tests.extras import needing

with needing("test,pictures"):
    from tests.groundstation.ui import frames
    from tests.groundstation.ui.png_palette import to_palette
    from tests.groundstation.ui.replay_picture import replay
    from tests.groundstation.ui.screenshots_connect import connect, files, links
    from tests.groundstation.ui.screenshots_drive import drive, mission, params
    from tests.groundstation.ui.screenshots_flight import flight
    from tests.groundstation.ui.screenshots_obstacles import obstacles


SIZES = ((80, 24), (140, 45))

GROUPS: dict[str, Callable[[tuple[int, int]], Awaitable[dict[str, frames.Picture]]]] = {
    "drive": drive,
    "map": mission,
    "params": params,
    "connect": connect,
    "files": files,
    "links": links,
    "flight": flight,
    "obstacles": obstacles,
    "replay": replay,
}
"""Name -> what takes the pictures of a size, by name. They become files later: that holds up the app's loop."""


def write_pictures(folder: Path, groups: list[str]) -> None:
    """Write the pictures of these groups into a folder, which is made if it is missing."""
    folder.mkdir(parents=True, exist_ok=True)
    for group in groups:
        for width, height in SIZES:
            for name, picture in asyncio.run(_await(GROUPS[group]((width, height)))).items():
                print(_write(folder / f"{name}_{width}x{height}", frames.svg(picture)), flush=True)


def _write(file: Path, svg: str) -> Path:
    drawn = file.with_suffix(".svg")
    drawn.write_text(svg, "utf-8")
    converter = shutil.which("rsvg-convert")
    if converter is None:
        return drawn
    png = subprocess.run([converter, drawn], check=True, capture_output=True).stdout
    drawn.unlink()
    file.with_suffix(".png").write_bytes(to_palette(png))
    return file.with_suffix(".png")


async def _await(made: Awaitable[dict[str, frames.Picture]]) -> dict[str, frames.Picture]:
    return await made


def main() -> None:
    """Take the pictures that the command line names."""
    parser = argparse.ArgumentParser(description="Make the pictures of the documents.")
    parser.add_argument("folder", type=Path)
    parser.add_argument("groups", nargs="*", metavar="GROUP", help=f"{', '.join(GROUPS)}; all by default")
    options = parser.parse_args()
    if unknown := set(options.groups) - set(GROUPS):
        parser.error(f"no group {', '.join(sorted(unknown))}; there are {', '.join(GROUPS)}")
    os.environ["COLORTERM"] = "truecolor"
    write_pictures(options.folder, options.groups or list(GROUPS))


if __name__ == "__main__":
    main()
