"""`mavhelm video`: shows a camera in the terminal, or writes one picture of it."""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from groundstation.cli.local.runner import UsageError, run_local
from groundstation.cli.terminal import needs_ascii
from groundstation.cli.verb_help import local_examples
from groundstation.pictures.png import encode_png
from groundstation.pictures.protocol import Protocol
from groundstation.video.decoder import find_program
from groundstation.video.ffmpeg_command import Shape
from groundstation.video.source import SHAPES, SourceError, VideoSource, parse_source
from link.runtime.command_line import CommandLineParser

MAX_RATE = 60.0
MIN_BYTES, MAX_BYTES = 10_000, 1_000_000_000
SNAPSHOT = (1280, 720)
"""Pixels of a file; a picture of other proportions has black borders."""
SNAPSHOT_WITHIN = 20.0
"""s for the first picture: a camera may send a whole one each 10 s."""

EPILOG = """\
The line below the picture has its age: the time since the last picture that differs from the one before. After 0.5 s it
is grey, and the line says OLD or FROZEN. What the camera and the network take is not known. docs/video.md

exit codes: 0 after q, 1 without a picture or if it crashed, 2 for wrong arguments
"""


def build_parser() -> CommandLineParser:
    """Return the parser of the command line."""
    parser = CommandLineParser(
        prog="mavhelm video",
        description="Show a camera in this terminal. It needs ffmpeg, or gst-launch-1.0 of GStreamer.",
        epilog=f"{local_examples('video')}\n\n{EPILOG}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("source", metavar="SOURCE", help=SHAPES)
    parser.add_argument("--snapshot", metavar="FILE.png", type=Path, help="write one picture and end")
    parser.add_argument(
        "--protocol", type=Protocol, choices=list(Protocol), metavar="PROTOCOL",
        help=f"how it is drawn: {', '.join(Protocol)} (default: the best that the terminal answers to)",
    )  # fmt: skip
    parser.add_argument("--rate", type=_rate, default=10.0, metavar="N", help="pictures a second at most (default: 10)")
    parser.add_argument(
        "--bytes", type=_bytes, dest="limit", metavar="N",
        help="bytes a second to the terminal at most (default: 8000000, or 250000 over SSH)",
    )  # fmt: skip
    return parser


def run(arguments: Sequence[str]) -> int:
    """Run `mavhelm video`; return the exit code."""
    return run_local(build_parser(), arguments, _perform)


def _perform(options: argparse.Namespace) -> int:
    try:
        source = parse_source(options.source, Path.cwd())
        find_program()
    except SourceError as error:
        raise UsageError(str(error)) from error
    if options.snapshot is not None:
        return _write_snapshot(source, options.snapshot)
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        raise UsageError("this is not a terminal: run `mavhelm video` in one, or give --snapshot FILE.png")
    return _show(source, options)


def _show(source: VideoSource, options: argparse.Namespace) -> int:
    from groundstation.ui.terminal.tty_output import redirect_output
    from groundstation.ui.video.viewer import Viewer, ViewerOptions  # loads Textual, which a snapshot does without

    given = ViewerOptions(options.protocol, options.rate, options.limit, needs_ascii())

    async def show() -> None:
        with redirect_output(None) as file:
            await Viewer(source, find_program(), given, file).run()

    asyncio.run(show())
    return 0


def _write_snapshot(source: VideoSource, path: Path) -> int:
    from groundstation.video.feed import take_snapshot

    try:
        with path.open("xb") as file:  # a picture that exists is not lost
            shape = Shape(*SNAPSHOT, rate=MAX_RATE)
            try:
                picture = asyncio.run(take_snapshot(source, find_program(), shape, SNAPSHOT_WITHIN))
            except BaseException:
                path.unlink()
                raise
            file.write(encode_png(picture))
    except FileExistsError as error:
        raise UsageError(f"{path} exists: give another name, or remove it") from error
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror}") from error
    except SourceError as error:
        sys.stderr.write(f"mavhelm: {error}\n")
        return 1
    with contextlib.suppress(OSError):
        os.write(1, f"wrote {path}: {picture.width} x {picture.height} pixels\n".encode())
    return 0


def _rate(text: str) -> float:
    with contextlib.suppress(ValueError):
        if 0.1 <= (rate := float(text)) <= MAX_RATE:
            return rate
    raise argparse.ArgumentTypeError(f"{text!r} is not a number from 0.1 to {MAX_RATE:g}")


def _bytes(text: str) -> int:
    if text.isascii() and text.isdecimal() and MIN_BYTES <= int(text) <= MAX_BYTES:
        return int(text)
    raise argparse.ArgumentTypeError(f"{text!r} is not a number from {MIN_BYTES} to {MAX_BYTES}")
