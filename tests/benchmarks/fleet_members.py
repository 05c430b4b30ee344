"""Vehicles of a fleet for the benchmark `fleet_load`: one process, a session with a certificate of its own for each.

python -m tests.benchmarks.fleet_members FOLDER FIRST COUNT RATE    sends the telemetry of `v1` to `vN`
python -m tests.benchmarks.fleet_members FOLDER listen              counts what arrives for the operator `bob`
"""

from __future__ import annotations

import itertools
import sys
import time
from pathlib import Path
from typing import Any

import zenoh

from link.endpoint import parse_endpoint
from link.fleet.brevity import BriefTelemetry
from link.fleet.config import load_config
from link.fleet.keys import FleetKeys, read_frame
from tests.benchmarks.fleet_sender import vehicle_frames

FLEET = "farm"
STEP = 0.02
"""s between two bursts; each has messages of every vehicle in turn."""
SYSTEMS = 250
"""System ids; of more vehicles, some have the same."""


class Sender:
    """One vehicle: whoever talks to it gets its telemetry, or a little of it, as of a real one."""

    def __init__(self, folder: Path, number: int) -> None:
        name = f"v{number}"
        endpoint = parse_endpoint(f"zenoh:{folder}/{name}.json5/{FLEET}/{name}")
        self._keys = FleetKeys(FLEET, name, None)
        self._first = number
        self._frames = vehicle_frames(1 + number % SYSTEMS)
        self._places: dict[str, list[Any]] = {}
        self._brief = BriefTelemetry()
        self._read = [frame for each in self._frames if (frame := read_frame(each))]
        self._session = zenoh.open(load_config(endpoint).zenoh)
        live = self._session.liveliness()
        self._token = live.declare_token(self._keys.token(""))
        self._listening = live.declare_subscriber(self._keys.others, self._meet, history=True)

    def send(self, number: int) -> None:
        """Send message `number` to each ground station. Each vehicle begins with another one, as real ones do."""
        at = (self._first + number) % len(self._frames)
        for address, places in list(self._places.items()):
            if self._brief.passes(self._read[at], address, time.monotonic()):
                self._session.put(places[at], self._frames[at])

    def _meet(self, sample: zenoh.Sample) -> None:
        key, is_there = str(sample.key_expr), sample.kind == zenoh.SampleKind.PUT
        if brief := self._keys.read_brief(key):
            self._brief.set(brief, is_brief=is_there)
        address = self._keys.read_token(key)
        if address is None:
            return
        if is_there:
            self._places[address] = [zenoh.KeyExpr(self._keys.place(each, address)) for each in self._read]
        else:
            self._places.pop(address, None)


def send(folder: Path, first: int, count: int, rate: int) -> None:
    """Send `rate` messages a second of each vehicle, until the process is ended."""
    senders = [Sender(folder, number) for number in range(first, first + count)]
    print("members ready", flush=True)
    start, sent = time.monotonic(), 0
    for burst in itertools.count(1):
        time.sleep(max(0.0, start + burst * STEP - time.monotonic()))
        due = round(burst * STEP * rate * count)
        for number in range(sent, due):
            senders[number % count].send(number // count)
        sent = due


def listen(folder: Path) -> None:
    """Talk to every vehicle as a ground station does; print once a second how many messages have arrived."""
    config = load_config(parse_endpoint(f"zenoh:{folder}/bob.json5/{FLEET}"))
    keys = FleetKeys(FLEET, "", "bob/1")
    session = zenoh.open(config.zenoh)
    live, tokens, count = session.liveliness(), [], itertools.count()

    def meet(sample: zenoh.Sample) -> None:
        address = keys.read_token(str(sample.key_expr))
        if address is not None and sample.kind == zenoh.SampleKind.PUT:
            tokens.append(live.declare_token(keys.token(address)))

    hears = session.declare_subscriber(keys.frames, lambda _: next(count))
    meets = live.declare_subscriber(keys.others, meet, history=True)
    while hears and meets:
        time.sleep(1.0)
        print(f"heard {len(tokens)} vehicles {next(count)} messages", flush=True)


if __name__ == "__main__":
    if sys.argv[2] == "listen":
        listen(Path(sys.argv[1]))
    send(Path(sys.argv[1]), *map(int, sys.argv[2:5]))
