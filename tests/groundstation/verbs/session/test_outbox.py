"""What a verb sends next: in which order, and for what."""

from __future__ import annotations

from dialects import messages as m
from groundstation.station.verbs.running_verbs import Purpose, VerbMessage
from groundstation.verbs.session.outbox import VerbOutbox
from link.core import Outgoing


def test_a_proof_leaves_before_what_was_made_before_it() -> None:
    outbox, ping = VerbOutbox(), m.Ping(0, 1, 1, 1)
    proof = VerbMessage(m.ManualControl(1, 0, 0, 0, 0, 0), Purpose.NEUTRAL)
    outbox.commands.append(Outgoing(ping))
    outbox.demands.append(proof)
    assert outbox.pop() == [proof, VerbMessage(ping)]
    assert outbox.pop() == []
