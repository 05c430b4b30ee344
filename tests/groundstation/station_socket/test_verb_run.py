"""The packets between a shell and the station that runs its verb, as they are on the socket."""

from __future__ import annotations

import pytest

from groundstation.station_socket.verb_run import (
    VERSION,
    Alive,
    AskedGroup,
    CancelVerb,
    FromShell,
    Printed,
    RunVerb,
    StillHere,
    ToShell,
    VerbEnded,
    VerbOutput,
    decode_from_shell,
    decode_from_station,
    encode,
)


def test_packets_of_version_8() -> None:
    """A shell and a station of two releases tell each other apart by the number: who changes a packet raises it."""
    group = AskedGroup(frozenset({2}), frozenset(), ("rover*",))
    assert VERSION == 8
    assert encode(RunVerb(("arm", "--all"), group)).hex() == (
        "85a474797065a752756e56657262a5776f72647392a361726da52d2d616c6ca567726f75709391029091a6726f7665722a"
        "a5676976656ec0a76469616c656374a0"
    )
    assert encode(VerbOutput((Printed("line", ("armed",), {"a": 1}),))).hex() == (
        "82a474797065aa566572624f7574707574a77072696e7465649193a46c696e6591a561726d656481a16101"
    )


@pytest.mark.parametrize("packet", [RunVerb(("status",)), StillHere(), CancelVerb()])
def test_what_a_shell_sends_arrives(packet: FromShell) -> None:
    assert decode_from_shell(encode(packet)) == packet


@pytest.mark.parametrize("packet", [Alive(), VerbEnded(4, "Rover 1"), VerbOutput((Printed("flush"),))])
def test_what_a_station_sends_arrives(packet: ToShell) -> None:
    assert decode_from_station(encode(packet)) == packet
