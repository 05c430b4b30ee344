"""Command line and log file of the station process."""

from __future__ import annotations

import argparse
import logging
import logging.handlers
from pathlib import Path

from groundstation.input.style import Style

LOG_SIZE = 1 << 20
LOG_FORMAT = "%(asctime)s %(levelname)s %(name)s: %(message)s"


def log_to(path: Path | None) -> None:
    """Write the log of all libraries to the file, or nowhere."""
    handler: logging.Handler = logging.NullHandler()
    if path is not None:
        handler = logging.handlers.RotatingFileHandler(path, maxBytes=LOG_SIZE, backupCount=1, encoding="utf-8")
    logging.basicConfig(level=logging.INFO, handlers=[handler], format=LOG_FORMAT)
    logging.captureWarnings(True)


def station_parser() -> argparse.ArgumentParser:
    """Return the parser of the station process."""
    parser = argparse.ArgumentParser(
        prog="groundstation.station_process", description="Started by `groundstation`, not by hand."
    )
    parser.add_argument("--fd", type=int, required=True, help="the station's end of the pipe")
    parser.add_argument("--system", type=int, default=255)
    parser.add_argument("--style", choices=list(Style), default=Style.HOLD)
    parser.add_argument("--speed", type=float, default=0.6)
    parser.add_argument("--sitl", action="store_true")
    parser.add_argument("--log-file", type=Path)
    parser.add_argument("--dialect", metavar="FILE.xml")
    parser.add_argument("--param-docs", type=Path, help="file with texts of parameters")
    parser.add_argument("--terminal", help="path of the screen's terminal, which is reset if the screen is killed")
    parser.add_argument("endpoints", nargs="*")
    return parser
