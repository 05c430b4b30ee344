"""Record a drive of the simulated rover with the real program, and draw it: make picture.

rsvg-convert (Debian: librsvg2-bin, with fonts-jetbrains-mono) draws the frames. Look at the picture before you
commit it: on a busy machine keys are late.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
from pathlib import Path

from tests.extras import needing

with needing("pictures"):
    from tests.animation import LARGEST, PICTURE, ROOT
    from tests.animation.asciicast import Cast, read_cast, write_cast
    from tests.animation.drawing import draw
    from tests.animation.recorder import record


RECORDING = ROOT / "build" / "drive.cast"


def main(words: list[str]) -> int:
    """Return 0, or 1 if no picture was made."""
    parser = argparse.ArgumentParser(prog="python -m tests.animation", description=__doc__.partition("\n")[0])
    parser.add_argument("--from", dest="cast", type=Path, metavar="CAST", help="draw this asciicast v2, record none")
    parser.add_argument("--out", type=Path, default=PICTURE, help="the animated PNG (default: docs/drive.png)")
    options = parser.parse_args(words)
    if shutil.which("rsvg-convert") is None:
        print("no rsvg-convert: apt-get install librsvg2-bin fonts-jetbrains-mono", file=sys.stderr)
        return 1
    try:
        cast = read_cast(options.cast) if options.cast else _record()
    except (OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 1
    count = draw(cast, options.out)
    size = options.out.stat().st_size
    print(f"{options.out}: {count} frames, {size / 1000:.0f} kB")
    if size > LARGEST:
        print(f"more than {LARGEST / 1000:.0f} kB: too large for README", file=sys.stderr)
    return int(size > LARGEST)


def _record() -> Cast:
    with tempfile.TemporaryDirectory(prefix="home-") as home:
        cast = record(Path(home))
    RECORDING.parent.mkdir(exist_ok=True)
    write_cast(cast, RECORDING)
    print(f"{RECORDING}: {cast.outputs[-1].at:.1f} s")
    return cast


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
