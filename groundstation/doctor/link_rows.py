"""Rows of the chain from the finger to the vehicle: keys, station, link, vehicle, dialect, ids."""

from __future__ import annotations

import math
from ipaddress import ip_address
from itertools import combinations

from msgspec import structs

from groundstation.doctor.facts import DoctorFacts, PathFact
from groundstation.doctor.finding import fault, ok, unknown, warn
from groundstation.snapshot import LinkView
from groundstation.views.doctor import ChainFinding
from link.runtime.diagnosis import Health

SLOW_TERMINAL = 0.25
"""s of a terminal's round trip from which on keys feel late: half of the 0.5 s within which a release must count."""

LOSS_WARNING, LOSS_FAULT = 0.05, 0.3
"""Lost share of the vehicle's frames: at 5 % a changed demand is late once in 20; at 30 % it often
stops itself."""

SLOW_LINK, STALE_LINK = 0.25, 0.45
"""s of the round trip. Above 0.45 (OPR_ECHO_MAX) a vehicle of our dialect refuses demands as stale."""

OBEYED = ("MAV_GCS_SYSID", "SYSID_MYGCS")
"""Parameters with the ground station that the vehicle obeys; 0 means any (our rover)."""

CRC_SHARE = 0.01
"""Bad share of the frames from which on the line is worth a look."""


def keys(facts: DoctorFacts) -> ChainFinding:
    """Judge what the terminal reports."""
    terminal, operator = facts.terminal, facts.operator
    if terminal is None:
        return unknown("does not apply: there is no screen")
    if terminal.silent:
        return fault("the terminal does not answer", "check the connection to this terminal")
    ping = _ping(terminal.round_trip)
    if terminal.round_trip is not None and terminal.round_trip > SLOW_TERMINAL:
        return warn(f"the terminal answers after {ping}: keys count late", "use a faster line, or drive slowly")
    if operator.reports_releases:
        return ok(f"this terminal reports key releases, ping {ping}")
    bound = "until the next key" if math.isinf(operator.stop_bound) else f"{operator.stop_bound:.2f} s at most"
    return ok(f"timers end a key press, {bound}; ping {ping}")


def _ping(seconds: float | None) -> str:
    """Return a round trip, which is known in steps of 5 ms."""
    if seconds is None:
        return "not answered yet"
    return f"{seconds * 1000:.0f} ms" if seconds else "below 5 ms"


def station(facts: DoctorFacts) -> ChainFinding:
    """Judge this station."""
    if facts.terminal is None:
        return unknown("does not apply: there is no screen")
    if facts.operator.gate_reason in ("screen not responding", "screen was frozen"):
        return warn(facts.operator.gate_reason, "wait 1 s; a busy computer is too slow to drive with")
    sends = f", sends {facts.operator.rate:.0f} demands/s" if facts.operator.sending else ""
    return ok(f"runs as system {facts.system}{sends}")


def link(facts: DoctorFacts) -> ChainFinding:
    """Judge the link of the vehicle, both ways."""
    where = ", ".join(facts.endpoints) or "no link"
    heard = facts.vehicle is not None and facts.vehicle.alive
    if heard and not any(each.frames for each in facts.links):
        return unknown(f"{where}: not measured yet")  # links are counted once a second
    if not any(each.frames for each in facts.links):
        down = next((each.problem for each in facts.links if each.problem), None)
        silence = (
            "bytes arrive, but no MAVLink" if any(each.bytes_received for each in facts.links) else "nothing heard"
        )
        return fault(f"{down or silence} on {where}", "check address, baud rate, cable and power", "app.links")
    if facts.vehicle is None:
        return unknown(f"{where}: no vehicle on it")
    found = _judge(_link_of(facts), facts)
    if found.health not in (Health.OK, Health.UNKNOWN):
        return found
    return next(filter(None, (_shared(found, *each) for each in combinations(facts.paths, 2))), found)


def _shared(found: ChainFinding, first: PathFact, second: PathFact) -> ChainFinding | None:
    """Return that two paths share a network, beside what was found of the link; None if they are not known to."""
    if first.local != second.local:
        return None
    both = first.link if first.link == second.link else f"{first.link} and {second.link}"
    if ip_address(first.host.partition("%")[0]).is_loopback:
        evidence = f"{found.evidence}; both paths ({both}) stay on this computer: what is behind is not known"
        return structs.replace(found, evidence=evidence)
    same = f"lead to {first.host}" if first.host == second.host else f"leave by {first.local}"
    text = f"{found.evidence}; both paths ({both}) {same}: one cut ends both"
    return warn(text, "let each path have a network of its own", "app.links")


def _link_of(facts: DoctorFacts) -> LinkView:
    """Return the link that carries the vehicle: the one that counts, else the one with the fewest losses."""
    assert facts.vehicle is not None
    carrying = [each for each in facts.links if facts.vehicle.system in each.systems] or list(facts.links)
    return min(carrying, key=lambda each: (not each.counts, 1.0 if each.loss is None else each.loss))


def _judge(each: LinkView, facts: DoctorFacts) -> ChainFinding:
    loss = each.loss or 0.0
    trip = "not answered" if each.round_trip is None else f"{each.round_trip * 1000:.0f} ms"
    text = f"{each.name}: round trip {trip}, {loss:.1%} lost, {each.crc_errors} bad"
    if loss > LOSS_FAULT or (each.round_trip or 0.0) > STALE_LINK:
        return fault(text, "move closer, or use a faster link: demands arrive too late", "app.links")
    bad = each.crc_errors > CRC_SHARE * max(1, each.frames)
    if loss > LOSS_WARNING or (each.round_trip or 0.0) > SLOW_LINK or bad:
        return warn(text, "check antenna, cable and baud rate", "app.links")
    if each.problem and not facts.mismatched:
        return warn(f"{each.name}: {each.problem}", "", "app.links")
    if each.round_trip is None:
        return unknown(text, "wait: the vehicle answers TIMESYNC, or PING is not known to it")
    return ok(text)


def vehicle(facts: DoctorFacts) -> ChainFinding:
    """Judge whether the vehicle is heard."""
    view = facts.vehicle
    if view is None:
        return unknown("no HEARTBEAT of a vehicle yet", "switch the vehicle on")
    if not view.alive:
        stops = f": {view.link_loss_action}" if view.link_loss_action else ""
        return fault(f"{view.name} lost for {view.silence:.0f} s{stops}", "check power and link", "app.links")
    if view.duplicates:
        advice = "give one of them another id (MAV_SYSID, SYSID_THISMAV, MAV_SYS_ID)"
        return fault(f"several vehicles use id {view.system}: {view.duplicates}", advice, "app.links")
    firmware = f", firmware {facts.firmware}" if facts.firmware else ""
    return ok(f"{view.name}{firmware}, heard {view.silence:.0f} s ago")


def dialect(facts: DoctorFacts) -> ChainFinding:
    """Judge whether both ends mean the same by a message."""
    if facts.vehicle is None:
        return unknown("after the vehicle is heard")
    if facts.mismatched:
        names = ", ".join(facts.mismatched[:3])
        return warn(
            f"other definition of {names}: they are dropped", "use the same dialect at both ends", "app.messages"
        )
    if facts.version_1:
        advice = "set it to MAVLink 2 if it knows that (ArduPilot: SERIALn_PROTOCOL 2)"
        return warn("MAVLink 1: it is answered in that version, and cannot sign", advice)
    share = facts.unknown_share or 0.0
    extra = f"; {share:.0%} of the frames are messages unknown here" if share >= 0.005 else ""
    return ok(("rover.xml, with proofs of each demand" if facts.rover_dialect else "common messages") + extra)


def our_id(facts: DoctorFacts) -> ChainFinding:
    """Judge whether we are who the vehicle obeys, and alone with our id."""
    if facts.id_conflict is not None:
        return fault(facts.id_conflict, f"end the other one, or {facts.another_id}")
    if facts.own_id:
        return fault("another program sends with our ids", f"end it, or {facts.another_id}", "app.links")
    if facts.vehicle is None:
        return ok(f"{facts.system}, nobody else has it")
    wanted = _obeyed(facts)
    if wanted not in (None, facts.system):
        return fault(
            f"the vehicle obeys ground station {wanted} only, this is {facts.system}", f"use --system {wanted}"
        )
    if facts.signs:
        return warn("the vehicle signs with a key that is not here", "mavhelm sign install NAME --words")
    return ok(f"{facts.system}, nobody else has it{', signed both ways' if facts.verified else ''}")


def _obeyed(facts: DoctorFacts) -> int | None:
    """Return the only ground station that the vehicle obeys; None: any, or not known."""
    settings = {each.name: each.value for each in facts.settings} | dict(facts.params)
    value = next((settings[name] for name in OBEYED if settings.get(name)), None)
    return None if value is None else int(value) & 0xFF  # ArduPilot accepts 300 and uses the low byte
