"""The benchmarks' command line: `python -m tests.benchmarks`. JSON to stdout, progress to stderr.

The exit code is 0 if every benchmark ran, whether it met its goals or not, 1 if one could not run, 2 for a usage error.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from tests.benchmarks import (
    bridge,
    bridge_stations,
    cost,
    fleet,
    fleet_load,
    fleet_outages,
    fleet_path,
    foreign_params,
    framer,
    hops,
    key_to_motor,
    link_loss,
    loop_lateness,
    machine,
    message_rates,
    mission,
    receive_path,
    recording,
    replay,
    screens,
    serial_key,
    services,
    signing,
    stations,
    strangers,
    tenth_core,
    verb,
)
from tests.benchmarks.figures import BenchmarkError, Options, Report
from tests.benchmarks.pictures import write_pictures
from tests.benchmarks.tables import markdown

BENCHMARKS: dict[str, tuple[Callable[[Options], Report], str]] = {
    "framer": (framer.run, "framing, decoding and encoding against pymavlink"),
    "receive_path": (receive_path.run, "the vehicle's work on one demand, from bytes to outputs"),
    "cost": (cost.run, "start-up time, memory and CPU of both programs"),
    "key_to_motor": (key_to_motor.run, "key byte on the terminal to motor outputs, against the common hobby form"),
    "hops": (hops.run, "where the time of a key goes, with each pane of Drive, beside a bare pair"),
    "serial_key": (serial_key.run, "the same over a serial cable at 57600 and 921600 baud"),
    "loop_lateness": (loop_lateness.run, "how late the vehicle's control cycles are, idle and on a busy machine"),
    "tenth_core": (tenth_core.run, "the vehicle with a tenth of a core: control cycles, keys, failsafes"),
    "bridge": (bridge.run, "the bridge as a router, beside MAVProxy, pymavlink and C"),
    "bridge_stations": (bridge_stations.run, "what 1, 10 and 100 ground stations cost a bridge"),
    "services": (services.run, "parameters, a mission and a log from a real vehicle, by UDP and at 57600 baud"),
    "foreign_params": (foreign_params.run, "1200 parameters of an ArduPilot-like vehicle, as a file and as a list"),
    "stations": (stations.run, "what 1, 4, 16 and 64 ground stations cost the vehicle"),
    "screens": (screens.run, "how long a screen takes to open, and key to motor with each pane of Drive"),
    "message_rates": (message_rates.run, "CPU of the ground station at 100 to 2000 messages/s"),
    "fleet": (fleet.run, "one driven rover among 15 and 99 further vehicles: key to motor and CPU"),
    "fleet_load": (fleet_load.run, "100 and 500 vehicles of a fleet: CPU and memory of router, station and vehicle"),
    "fleet_outages": (fleet_outages.run, "a driven rover of a fleet while networks are cut and routers fail; root"),
    "fleet_path": (fleet_path.run, "what the way through a fleet's router adds to plain UDP"),
    "signing": (signing.run, "what signing costs: a frame each way, and key to motor when both ends sign"),
    "strangers": (strangers.run, "CPU, demands and stops of a vehicle that strangers flood"),
    "verb": (verb.run, "verbs of the command line, by their own link and through a station"),
    "recording": (recording.run, "what recording costs the station at 1000 messages/s"),
    "replay": (replay.run, "a log of 1 GB: first snapshot, index, jumps, memory"),
    "mission": (mission.run, "ten minutes of AUTO in real time: how far the rover really is beside its lines"),
    "link_loss": (link_loss.run, "key to motor over a network that delays and loses"),
}
"""Name -> its function, and what it measures. To add one: a module with `run(Options) -> Report` and a line here."""

TLOG = machine.ROOT.parent / "shared" / "data" / "ardurover.tlog"
"""Recorded traffic, if it is beside the checkout."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the selected benchmarks; return the exit code."""
    asked = _parser().parse_args(argv)
    options = Options(quick=asked.quick, tlog=asked.tlog, say=_say, seeds=tuple(asked.seed or (1,)))
    facts, failures = machine.facts(), {}
    reports: dict[str, Report] = {}
    for name in asked.only or BENCHMARKS:
        started = time.monotonic()
        try:
            reports[name] = BENCHMARKS[name][0](options)
        except Exception as error:  # the others still run; the exit code reports it
            failures[name] = str(error)
            _tell(name, error)
        _say(f"{name}: {time.monotonic() - started:.0f} s")
    facts["load_after"] = machine.load()
    _write(asked, facts, reports, failures)
    return 1 if failures else 0


def _write(
    asked: argparse.Namespace, facts: dict[str, Any], reports: dict[str, Report], failures: dict[str, str]
) -> None:
    results = {name: report.plain() for name, report in reports.items()}
    run = {"quick": asked.quick, "machine": facts, "results": results, "failed": failures}
    text = json.dumps(run, indent=1)
    if asked.pictures:
        for file in write_pictures(run, asked.pictures):
            _say(f"{file} written")
    if asked.out:
        asked.out.write_text(text + "\n")
    print(markdown(facts, reports, quick=asked.quick) if asked.markdown else text)


def _tell(name: str, error: Exception) -> None:
    _say(f"{name} could not run: {error}")
    if not isinstance(error, BenchmarkError):
        traceback.print_exception(error)


def _say(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


def _parser() -> argparse.ArgumentParser:
    names = "\n".join(f"  {name:14}{text}" for name, (_, text) in BENCHMARKS.items())
    parser = argparse.ArgumentParser(
        prog="python -m tests.benchmarks",
        description="Measure both programs beside a reference in the same run.",
        epilog=f"benchmarks:\n{names}\n\nA full run takes about 55 minutes and wants the machine for itself.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--only", metavar="NAME", action="append", choices=BENCHMARKS, help="this one; repeatable")
    parser.add_argument("--quick", action="store_true", help="a short run, to see that they work")
    parser.add_argument("--out", metavar="FILE", type=Path, help="write the JSON to FILE too")
    parser.add_argument("--pictures", metavar="FOLDER", type=Path, help="write pictures of how cost grows to FOLDER")
    parser.add_argument("--markdown", action="store_true", help="print tables for docs/performance.md instead of JSON")
    parser.add_argument(
        "--seed",
        metavar="N",
        type=int,
        action="append",
        help="of the sensors' noise of `mission` (default 1); repeatable",
    )
    parser.add_argument(
        "--tlog",
        metavar="FILE",
        default=str(TLOG) if TLOG.exists() else None,
        help="telemetry log for the framer (default: ardurover.tlog where it lies beside the checkout)",
    )
    return parser


if __name__ == "__main__":
    sys.exit(main())
