"""Command line of `mavhelm bridge doctor`."""

from __future__ import annotations

import argparse
import asyncio
import json
import logging
import math
import sys
from collections.abc import Iterable, Sequence
from typing import Any

from dialects.extra.errors import DialectError
from dialects.extra.option import use_dialect
from link.bridge.doctor.listen import examine_endpoints
from link.bridge.doctor.machine import examine_machine
from link.bridge.doctor.table import examine
from link.endpoint import EndpointError, endpoint_help, parse_endpoints
from link.runtime import stdio
from link.runtime.command_line import USAGE_ERROR, CommandLineParser
from link.runtime.diagnosis import STOPPED, Finding, ReportRow, find_faults, format_row, row_record

DEFAULT_TIME = 5.0
"""s: each system sends a HEARTBEAT a second, and three frames prove another dialect."""
LONGEST = 3600.0
INTERRUPTED = 130
"""Exit code after Ctrl-C, 128 + SIGINT."""

HELP = """\
It opens each endpoint as the bridge would, listens, and closes it again. No byte is sent, so that
a program which sends only after it was sent to (udpout; some behind TCP) is not heard. Opening a
serial port raises DTR, as every program does; some boards restart then. A port that another
program has open is not taken from it: the answer tells which program, as far as the system tells.
Without endpoints it lists the serial ports and usual network ports of this machine.

examples:
  mavhelm bridge doctor                                                 what is plugged in, what is taken by whom
  mavhelm bridge doctor serial:/dev/ttyAMA0:57600 udpin:0.0.0.0:14550   as the bridge would run, for 5 s
  mavhelm bridge doctor udpin:0.0.0.0:14550 --for 30 --json

endpoints:
{endpoints}

exit codes: 0 nothing stops the bridge, 2 usage error, 7 a fault (X), 130 Ctrl-C.
"""


def run(arguments: Sequence[str]) -> int:
    """Examine, print, and return the exit code."""
    parser = build_parser()
    options = parser.parse_args(parser.reject_empty(arguments))
    stdio.log_plainly(logging.StreamHandler(), logging.WARNING, "bridge doctor: %(message)s")
    try:
        use_dialect(options.dialect)
        code = _examine(options)
        sys.stdout.flush()
    except (EndpointError, DialectError) as error:
        parser.exit(USAGE_ERROR, f"{parser.prog}: {error}\n")
    except KeyboardInterrupt:
        return INTERRUPTED
    except OSError as error:  # the output, full or closed by its reader
        return stdio.end_output(error, lambda reason: parser.exit(1, f"{parser.prog}: {reason}\n"))
    return code


def _examine(options: argparse.Namespace) -> int:
    endpoints = parse_endpoints(options.endpoints)
    if not endpoints:
        return _finish(_print("", examine_machine(), options.json), options.json)
    sys.stderr.write(f"mavhelm bridge doctor: listening for {options.time:g} s, nothing is sent\n")
    faults: list[dict[str, str]] = []
    for facts in asyncio.run(examine_endpoints(endpoints, options.time)):
        faults += _print(facts.endpoint.text, examine(facts), options.json)
    return _finish(faults, options.json)


def _print(endpoint: str, found: Iterable[ReportRow[Finding]], as_json: bool) -> list[dict[str, str]]:
    """Print the rows of an endpoint ("" for those of the machine); return its faults for JSON."""
    rows, of = tuple(found), {"endpoint": endpoint} if endpoint else {}
    lines = [endpoint] if endpoint else []
    lines += [line for row in rows for line in format_row(row)]
    if as_json:
        lines = [json.dumps(of | row_record(row)) for row in rows]
    sys.stdout.writelines(f"{line}\n" for line in lines)
    return [of | {"row": row.id} for row in find_faults(rows)]


def _finish(faults: Sequence[dict[str, str]], as_json: bool) -> int:
    if as_json:
        sys.stdout.write(json.dumps({"ok": not faults, "faults": list(faults)}) + "\n")
    return STOPPED if faults else 0


def _seconds(text: str) -> float:
    try:
        seconds = float(text)
    except ValueError:
        seconds = math.nan
    if not 0.0 < seconds <= LONGEST:
        raise argparse.ArgumentTypeError(f"{text!r} is not a time from 0 to {LONGEST:g} s")
    return seconds


def build_parser() -> CommandLineParser:
    """Return the parser of the command line."""
    parser = CommandLineParser(
        prog="mavhelm bridge doctor",
        description="Tells what arrives on endpoints, who is heard, and where their frames would go.",
        epilog=HELP.format(endpoints=endpoint_help()),
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    options: dict[str, dict[str, Any]] = {
        "endpoints": {"nargs": "*", "metavar": "ENDPOINT", "help": "one end of the bridge"},
        "--for": {"dest": "time", "metavar": "S", "type": _seconds, "default": DEFAULT_TIME,
                  "help": f"listen for S seconds (default {DEFAULT_TIME:g})"},
        "--json": {"action": "store_true", "help": "print one JSON object per row"},
        "--dialect": {"metavar": "FILE.xml", "help": "definitions of a vehicle that sends messages of its own"},
    }  # fmt: skip
    for name, settings in options.items():
        parser.add_argument(name, **settings)
    return parser
