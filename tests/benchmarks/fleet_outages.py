"""A rover that is driven through a fleet while its network or its router fails, with real programs in own networks.

Needs root. Two linked routers; the network cuts drop packets without a word, as a mobile network does.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack

from tests.benchmarks.figures import BenchmarkSkippedError, Goal, Options, Report, Row, Table
from tests.benchmarks.programs import scratch
from tests.e2e.fleet_driver import ROUTERS, VEHICLE, Fleet, Outage
from tests.e2e.namespaces import Namespaces, why_not

TRANSPORTS = {"TLS": False, "QUIC": True}
BACK_WITHIN = 1.0
"""s from the end of an outage to a command that is obeyed."""

_Suffer = Callable[[Fleet, Namespaces], Outage]


def _cut(seconds: float) -> _Suffer:
    def suffer(fleet: Fleet, networks: Namespaces) -> Outage:
        with ExitStack() as cut:
            return fleet.suffer(seconds, lambda: cut.enter_context(networks.cut(VEHICLE)), cut.close)

    return suffer


def _freeze(fleet: Fleet, networks: Namespaces) -> Outage:
    """Freeze the router in use; it goes on before the wheels are looked at for the last time."""
    in_use = fleet.router_in_use
    found = fleet.suffer(7.0, in_use.freeze, lambda: None)
    thawed = fleet.wires.now
    in_use.thaw()
    fleet.rest()
    moved = found.moved or fleet.wires.vehicle.moved_since(thawed)
    return Outage(found.stood, found.silence, found.back, found.obeyed, moved)


def _kill(fleet: Fleet, networks: Namespaces) -> Outage:
    """Kill the router that the driver uses now, and start it again afterwards."""
    in_use = fleet.router_in_use
    found = fleet.suffer(3.0, in_use.kill, lambda: None)
    in_use.start()
    return found


OUTAGES: dict[str, _Suffer] = {
    "vehicle's network cut for 4 s": _cut(4.0),
    "vehicle's network cut for 25 s": _cut(25.0),
    "router in use frozen for 7 s": _freeze,
    "router in use killed": _kill,
}


def run(options: Options) -> Report:
    """Go through each outage over each transport."""
    if reason := why_not():
        raise BenchmarkSkippedError(reason)
    found: dict[tuple[str, str], Outage] = {}
    for transport, quic in TRANSPORTS.items():
        with scratch() as folder, ExitStack() as stack:
            networks = Namespaces([*ROUTERS, VEHICLE], stack)
            fleet = Fleet(folder, stack, networks, quic=quic)
            for name, suffer in OUTAGES.items():
                if not (options.quick and "25" in name):
                    options.say(f"fleet_outages: {transport}, {name}")
                    found[transport, name] = suffer(fleet, networks)
    return _report(found)


def _report(found: dict[tuple[str, str], Outage]) -> Report:
    rows: list[Row] = [
        {
            "over": transport,
            "outage": name,
            "wheels stand after s": each.stood,
            "silence s": each.silence,
            "first frame after its end s": each.back,
            "obeyed after that s": each.obeyed,
            "moved by what was kept": "YES" if each.moved else "no",
        }
        for (transport, name), each in found.items()
    ]
    outages = found.values()
    goals = [
        Goal("outages after which kept demands moved the wheels", sum(each.moved for each in outages), 0, ""),
        Goal("link back to obeyed, worst", max(each.back + each.obeyed for each in outages), BACK_WITHIN, "s"),
    ]
    note = (
        "Full throttle when it begins, and through its first half. All demands since its middle are neutral, so that "
        "any motion after its end is of an old one. Silence: the longest time without a frame of the vehicle."
    )
    return Report([Table("A driven rover of a fleet with two routers", rows, note)], goals)
