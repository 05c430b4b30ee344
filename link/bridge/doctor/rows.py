"""Rows of `mavhelm bridge doctor`: does an endpoint open, what arrives, who is heard, where it would go."""

from __future__ import annotations

from dialects.enums import Autopilot, type_name
from link.bridge.doctor.facts import EndpointFacts, ForwardRoute, Source
from link.endpoint import LISTENING
from link.runtime.diagnosis import Finding, fault, ok, unknown, warn

AUTOPILOTS: dict[int, str] = {Autopilot.ARDUPILOT: " of ArduPilot", Autopilot.PX4: " of PX4"}
CRC_SHARE, CRC_LEAST = 0.01, 3
"""Damaged share of the frames from which on the line is worth a look; a stream joined within a frame has one or two."""
NOISE_LEAST = 600
"""Bytes outside of frames that are worth a look: a stream joined within a frame has up to 280."""
SHOWN = 6
"""Names in one row."""
SILENT_ADVICE = {
    "serial": "check power, and TX to RX on both sides",
    "tcpout": "the other program may wait for a HEARTBEAT first; this one sends nothing",
    "udpin": "send to this port from the other end; check its address, and firewalls between",
    "tcpin": "connect to this port from the other end; a program that waits for a HEARTBEAT first sends nothing now",
}
AFTER_OPENING, AFTER_FRAMES = unknown("after the endpoint works"), unknown("after frames arrive")


def opens(facts: EndpointFacts) -> Finding:
    """Judge whether the endpoint opens, and who has its port if not."""
    if facts.problem:
        evidence, _, advice = facts.problem.partition("; ")
        by = f": {', '.join(facts.holders)}" if facts.holders else ""
        return fault(f"{evidence}{by}", advice or "start the other end, or check address and port")
    return ok("listens" if facts.endpoint.scheme in LISTENING else "opens")


def arriving(facts: EndpointFacts) -> Finding:
    """Judge whether anything arrives. A listening endpoint may be silent while another one is heard."""
    scheme, heard = facts.endpoint.scheme, facts.heard
    if heard.received:
        many = f" from {heard.addresses} addresses" if heard.addresses > 1 else ""
        return ok(f"{heard.received} in {facts.seconds:g} s{many}")
    if facts.problem:
        return AFTER_OPENING
    nothing = f"nothing arrives in {facts.seconds:g} s"
    if scheme == "udpout":
        return unknown(f"{nothing}: the other end replies to senders only, and nothing is sent",
                       "run the bridge, and watch its table")  # fmt: skip
    silent = warn if scheme in LISTENING and facts.others_heard else fault
    return silent(nothing, SILENT_ADVICE.get(scheme, ""))


def frames(facts: EndpointFacts) -> Finding:
    """Judge whether the bytes are MAVLink."""
    heard = facts.heard
    if not heard.received:
        return unknown("after bytes arrive")
    if heard.frames:
        return ok(f"{heard.frames} of MAVLink, {heard.frames / facts.seconds:.0f}/s")
    if heard.crc_errors or heard.unknown:
        return fault("none of this dialect", "see dialect below; else the line is bad")
    remedy = "wrong baud rate: try 57600, 115200, 921600" if facts.endpoint.scheme == "serial" else "not MAVLink"
    return fault("bytes arrive, but no MAVLink frame", remedy)


def damage(facts: EndpointFacts) -> Finding:
    """Judge the share of damaged frames, and bytes between frames."""
    heard = facts.heard
    if not heard.received:
        return unknown("after bytes arrive")
    text = f"{heard.crc_errors} bad frames, {heard.noise} bytes of noise"
    if heard.mismatched:
        return unknown(f"{text}: see dialect")
    if heard.crc_errors >= CRC_LEAST and heard.crc_errors > CRC_SHARE * heard.frames:
        return warn(text, "check cable, antenna and baud rate")
    if heard.noise >= NOISE_LEAST:
        return warn(text, "another program may write to this line: a login console, ModemManager")
    return ok(text)


def dialect(facts: EndpointFacts) -> Finding:
    """Judge messages that this dialect does not know, or defines in another way."""
    heard = facts.heard
    if heard.mismatched:
        names = ", ".join(heard.mismatched[:SHOWN])
        return warn(f"another definition of {names}: the bridge drops them", "add --dialect FILE.xml")
    if heard.unknown:
        ids = ", ".join(map(str, heard.unknown_ids[:SHOWN]))
        return warn(
            f"{heard.unknown} frames with unknown ids ({ids}): forwarded to everybody", "--dialect FILE.xml names them"
        )
    return ok("all messages are known") if heard.frames else AFTER_FRAMES


def heard(facts: EndpointFacts) -> Finding:
    """Tell which systems are heard."""
    sources = facts.heard.sources
    if not sources:
        return AFTER_FRAMES
    text = "; ".join(map(_source, sources[:SHOWN]))
    more = f" (+{len(sources) - SHOWN})" if len(sources) > SHOWN else ""
    if all(each.kind is None for each in sources):
        return warn(f"{text}{more}", "no HEARTBEAT: wait longer (--for), or the sender is not complete")
    return ok(f"{text}{more}")


def _source(source: Source) -> str:
    kind = "no HEARTBEAT"
    if source.kind is not None:
        kind = f"{type_name(source.kind)}{AUTOPILOTS.get(source.autopilot or 0, '')}"
    return f"{source.system}/{source.component} {kind}{', signed' if source.signed else ''}"


def routes(facts: EndpointFacts) -> Finding:
    """Tell where the frames of each system would go, and what would come back to it."""
    if not facts.routes:
        return AFTER_FRAMES
    if facts.alone:
        return unknown("one endpoint: nothing to forward to", "name the other endpoints of the bridge as well")
    doubled = next((each for each in facts.routes if each.also_on), None)
    if doubled is not None:
        return warn(
            f"{doubled.system}/{doubled.component} is heard on {', '.join(doubled.also_on)} as well",
            "right for redundant links; two vehicles need two system ids",
        )
    return ok("; ".join(map(_route, facts.routes[:SHOWN])))


def _route(route: ForwardRoute) -> str:
    name = f"{route.system}/{route.component}"
    where = ", ".join(route.broadcasts)
    return f"{name} -> {where}" if where else f"{name} -> nobody is there yet"
