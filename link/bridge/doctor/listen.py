"""Opens endpoints and listens on them for some seconds."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from functools import partial

import msgspec

from link.bridge.doctor.facts import EndpointFacts
from link.bridge.doctor.listener import EndpointListener
from link.endpoint import SCHEMES, Endpoint
from link.transport.processes import find_socket_holders
from link.transport.serial_ports import find_holders
from link.transport.transport import LinkError, Transport
from link.transport.transports import load_factory

TICK = 0.05
"""s between two checks for partial frames, as the bridge does."""


class _Opened(msgspec.Struct, frozen=True):
    endpoint: Endpoint
    transport: Transport | None
    problem: str = ""


async def examine_endpoints(endpoints: Sequence[Endpoint], seconds: float) -> list[EndpointFacts]:
    """Listen for `seconds`; return the facts of each endpoint. Endpoints that do not open leave the others."""
    opened = [_open(each) for each in endpoints]
    transports = [each.transport for each in opened if each.transport is not None]
    listener = EndpointListener([(each.stream, each.fixed_address) for each in transports])
    try:
        await _listen(transports, listener, seconds)
        return _facts(opened, transports, listener, seconds)
    finally:
        for transport in transports:
            transport.close()


def _open(endpoint: Endpoint) -> _Opened:
    try:
        return _Opened(endpoint, load_factory(SCHEMES[endpoint.scheme])(endpoint))
    except LinkError as error:
        return _Opened(endpoint, None, _bare(endpoint, str(error)))


async def _listen(transports: Sequence[Transport], listener: EndpointListener, seconds: float) -> None:
    loop = asyncio.get_running_loop()
    for link, transport in enumerate(transports):
        transport.start(loop, _taker(listener, link, loop), partial(listener.handle_disconnect, link))
    end = loop.time() + seconds
    while (left := end - loop.time()) > 0:
        await asyncio.sleep(min(TICK, left))
        listener.tick(loop.time())


def _taker(listener: EndpointListener, link: int, loop: asyncio.AbstractEventLoop) -> Callable[..., None]:
    return lambda pieces: listener.receive(link, pieces, loop.time())


def _facts(
    opened: Sequence[_Opened], transports: Sequence[Transport], listener: EndpointListener, seconds: float
) -> list[EndpointFacts]:
    heard = [listener.heard(link) for link in range(len(transports))]
    names = ["" if each.problem else each.endpoint.text for each in transports]
    facts = []
    for each in opened:
        if each.transport is None:
            facts.append(EndpointFacts(each.endpoint, seconds, each.problem, _holders(each.endpoint)))
            continue
        link = transports.index(each.transport)
        problem = _bare(each.endpoint, each.transport.problem or "")
        facts.append(
            EndpointFacts(
                each.endpoint,
                seconds,
                problem,
                _holders(each.endpoint) if problem else (),
                heard[link],
                listener.routes(link, names),
                alone=len(opened) == 1,
                others_heard=any(one.frames for other, one in enumerate(heard) if other != link),
            )
        )
    return facts


def _bare(endpoint: Endpoint, text: str) -> str:
    """Return a problem without the name of its endpoint, and without what only a running program does."""
    return text.removeprefix(f"{endpoint.text}: ").removesuffix("; trying again").removeprefix("waiting for ")


def _holders(endpoint: Endpoint) -> tuple[str, ...]:
    """Return who has the port of an endpoint on this machine; nobody for one at another machine."""
    if endpoint.path:
        return tuple(find_holders([endpoint.path]).values())
    if endpoint.scheme == "udpin":
        return tuple(find_socket_holders("udp", endpoint.port))
    return tuple(find_socket_holders("tcp", endpoint.port)) if endpoint.scheme == "tcpin" else ()
