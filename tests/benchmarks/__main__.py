"""The benchmarks' command line: `python -m tests.benchmarks`. JSON to stdout, progress to stderr.

The exit code is 0 if every benchmark ran, whether it met its goals or not, 1 if one could not run, 2 for a usage error.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tests.extras import needing

with needing("test"):
    from tests.benchmarks import (
        bridge,
        bridge_stations,
        calls,
        cost,
        document,
        drive_picture,
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
        message_rates,
        mission,
        receive_path,
        recording,
        replay,
        rover_program,
        screens,
        serial_key,
        services,
        signing,
        stations,
        strangers,
        tenth_core,
        two_links,
        verb,
        video_frames,
    )
    from tests.benchmarks.figures import BenchmarkError, Options
    from tests.benchmarks.pictures import write_pictures
    from tests.benchmarks.run import Benchmark, Run, say
    from tests.recorded import WHOLE_ARDUROVER


BENCHMARKS: dict[str, tuple[Benchmark, str]] = {
    "cost": (cost.run, "start-up time, memory and CPU of both programs"),
    "stations": (stations.run, "what 1, 4, 16 and 64 ground stations cost the vehicle"),
    "message_rates": (message_rates.run, "CPU of the ground station at 100 to 2000 messages/s"),
    "fleet": (fleet.run, "one driven rover among 15 and 99 further vehicles: key to motor and CPU"),
    "bridge_stations": (bridge_stations.run, "what 1, 10 and 100 ground stations cost a bridge"),
    "key_to_motor": (key_to_motor.run, "key byte on the terminal to motor outputs, against the common hobby form"),
    "hops": (hops.run, "where the time of a key goes, with each pane of Drive, beside a bare pair"),
    "screens": (screens.run, "how long a screen takes to open, and key to motor with each pane of Drive"),
    "link_loss": (link_loss.run, "key to motor over a network that delays and loses"),
    "two_links": (two_links.run, "driving over two links while one is cut, late, lossy, reordered or frozen; root"),
    "serial_key": (serial_key.run, "key to motor over a serial cable at 57600 and 921600 baud, also with noise"),
    "tenth_core": (tenth_core.run, "the vehicle with a tenth of a core: control cycles, keys, failsafes"),
    "loop_lateness": (loop_lateness.run, "how late the vehicle's control cycles are, idle and on a busy machine"),
    "signing": (signing.run, "what signing costs: a frame each way, and key to motor when both ends sign"),
    "fleet_path": (fleet_path.run, "what the way through a fleet's router adds to plain UDP"),
    "fleet_load": (fleet_load.run, "100 and 500 vehicles of a fleet: CPU and memory of router, station and vehicle"),
    "receive_path": (receive_path.run, "the vehicle's work on one demand, from bytes to outputs"),
    "bridge": (bridge.run, "the bridge as a router, beside MAVProxy, pymavlink and C"),
    "mission": (mission.run, "ten minutes of AUTO in real time: how far the rover really is beside its lines"),
    "framer": (framer.run, "framing, decoding and encoding against pymavlink"),
    "services": (services.run, "parameters, a mission and a log from a real vehicle, by UDP and at 57600 baud"),
    "foreign_params": (foreign_params.run, "1200 parameters of an ArduPilot-like vehicle, as a file and as a list"),
    "fleet_outages": (fleet_outages.run, "a driven rover of a fleet while networks are cut and routers fail; root"),
    "strangers": (strangers.run, "CPU, demands and stops of a vehicle that strangers flood"),
    "verb": (verb.run, "verbs of the command line, by their own link and through a station"),
    "rover": (rover_program.run, "a program with Rover: start to first motion, memory and CPU while it drives"),
    "recording": (recording.run, "what recording costs the station at 1000 messages/s"),
    "calls": (calls.run, "functions that a key, a view and a snapshot call, counted in virtual time"),
    "drive_picture": (drive_picture.run, "driving by a picture: age of what is seen, key to motor, CPU"),
    "video_frames": (video_frames.run, "a frame of video: CPU and bytes for each way to draw it"),
    "replay": (replay.run, "a log of 1 GB: first snapshot, index, jumps, memory"),
}
"""Name -> its function, and what it measures. To add one: a module with `run(Options) -> Report` and a line here."""

BESIDE = "mission"
"""Runs beside those after it: it waits for most of its ten minutes, and their goals are ratios or seconds."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the selected benchmarks, or read an earlier run, and write what is asked for; return the exit code."""
    asked = _parser().parse_args(argv)
    try:
        results = json.loads(asked.source.read_text()) if asked.source else _measure(asked)
        _write(asked, results)
    except (BenchmarkError, OSError, ValueError, KeyError) as error:
        lacks = f"it has no {error}" if isinstance(error, KeyError) else str(error)
        say(f"{asked.source}: {lacks}" if asked.source else f"benchmarks: {lacks}")
        return 2
    return 1 if results["failed"] else 0


def _measure(asked: argparse.Namespace) -> dict[str, Any]:
    options = Options(quick=asked.quick, tlog=asked.tlog, say=say, seeds=tuple(asked.seed or (1,)))
    run = Run({name: each for name, (each, _) in BENCHMARKS.items()}, options, asked.out)
    run.measure(asked.only or list(BENCHMARKS), beside=BESIDE)
    return run.results


def _write(asked: argparse.Namespace, results: dict[str, Any]) -> None:
    if asked.pictures:
        for file in write_pictures(results, asked.pictures):
            say(f"{file} written")
    if asked.into:
        document.replace(asked.into, document.results(results))
    print(document.results(results) if asked.markdown else json.dumps(results, indent=1))


def _parser() -> argparse.ArgumentParser:
    names = "\n".join(f"  {name:16}{text}" for name, (_, text) in BENCHMARKS.items())
    parser = argparse.ArgumentParser(
        prog="python -m tests.benchmarks",
        description="Measure both programs beside a reference in the same run.",
        epilog=f"benchmarks:\n{names}\n\nA full run takes about 57 minutes and wants the machine for itself.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--only", metavar="NAME", action="append", choices=BENCHMARKS, help="this one; repeatable")
    parser.add_argument("--quick", action="store_true", help="a short run, to see that they work")
    parser.add_argument("--out", metavar="FILE", type=Path, help="write the JSON to FILE, after each benchmark")
    parser.add_argument("--from", metavar="FILE", type=Path, dest="source", help="measure nothing: read such a JSON")
    parser.add_argument("--pictures", metavar="FOLDER", type=Path, help="write pictures of how cost grows to FOLDER")
    parser.add_argument("--markdown", action="store_true", help="print Markdown instead of JSON")
    parser.add_argument("--into", metavar="FILE", type=Path, help="write the Markdown between the marks of a document")
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
        default=str(WHOLE_ARDUROVER),
        help="telemetry log for the framer (default: tests/recordings/ardurover-whole.tlog.xz)",
    )
    return parser


if __name__ == "__main__":
    sys.exit(main())
