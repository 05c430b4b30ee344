"""From when on a verb knows that each sender was heard: a stop is not done before that."""

from __future__ import annotations

import asyncio

from groundstation.station.core_parts import CoreParts
from groundstation.station.operator_core import OperatorCore
from groundstation.verbs.session.core import ALONE_AFTER, VerbCore
from groundstation.verbs.session.session import VerbSession


async def begin(core: VerbCore) -> VerbSession:
    return VerbSession(core, lambda: None, lambda report: None)


async def begin_alone() -> VerbSession:
    return await begin(VerbCore.alone((255, 190), None, 7, now=asyncio.get_running_loop().time()))


def in_a_station(started: float) -> VerbSession:
    return asyncio.run(begin(VerbCore(OperatorCore(CoreParts((), now=started)), None)))


def test_a_verb_waits_for_links_that_were_not_heard_long_enough() -> None:
    """Of a station as of its own; a station that runs for longer has heard each sender."""
    own = asyncio.run(begin_alone())
    assert own.sure_at == own.station.parts.started + ALONE_AFTER > own.began
    assert own.next_within() == ALONE_AFTER
    new = in_a_station(own.began)
    assert new.sure_at == max(own.began + ALONE_AFTER, new.began) > own.began
    old = in_a_station(own.began - 60.0)
    assert old.sure_at == old.began
