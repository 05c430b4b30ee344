"""The version of MAVLink in which a message goes to the systems behind an address."""

from __future__ import annotations

from link.core import Peer
from link.protocol.framer import Framer
from link.protocol.peer import PeerState
from tests.rows import each_row

OLD, NEW = b"\xfe", b"\xfd"
"""First byte of a frame of each version."""


@each_row(
    ("heard", "number", "target", "versions"),
    [
        ({1: OLD}, 76, 1, (1,)),
        ({1: OLD}, 255, 1, (1,)),
        ({1: OLD}, 256, 1, (2,)),
        ({1: OLD}, 76, 9, (2,)),
        ({1: OLD}, 253, 0, (1,)),
        ({1: OLD}, 0, 0, (2, 1)),
        ({1: NEW}, 76, 1, (2,)),
        ({1: NEW}, 0, 0, (2,)),
        ({1: NEW}, 253, 0, (2,)),
        ({1: OLD, 2: NEW}, 76, 1, (1,)),
        ({1: OLD, 2: NEW}, 76, 2, (2,)),
        ({1: OLD, 2: NEW}, 253, 0, (2, 1)),
        ({}, 0, 0, (2,)),
    ],
)
def test_each_system_gets_the_version_that_it_sends(
    heard: dict[int, bytes], number: int, target: int, versions: tuple[int, ...]
) -> None:
    state = PeerState(Peer(0, "here", 0), Framer(stream=False), 0.0)
    for system, raw in heard.items():
        state.note_frame(system, raw)
    assert state.versions(number, target) == versions
