"""The channel between a verb and its companion, and how a companion ends."""

from __future__ import annotations

import asyncio

import pytest

from groundstation.station_socket.verb_run import PIECE, split
from groundstation.verbs.client.companion import local_companion
from groundstation.verbs.common.channel import ChannelEndedError, CompanionChannel
from groundstation.verbs.common.exit_codes import ExitCode, VerbError


def test_a_large_value_arrives_in_pieces() -> None:
    async def main() -> None:
        channel, value = CompanionChannel(), ["x" * PIECE, {"nan": float("inf")}, b"end"]
        pieces = list(split(value))
        assert len(pieces) == 2
        for data, whole in pieces:
            channel.push_piece(data, whole=whole)
        assert await channel.receive() == value

    asyncio.run(main())


def test_values_arrive_before_the_end() -> None:
    async def main() -> None:
        channel = CompanionChannel()
        channel.push(1)
        channel.end()
        assert await channel.receive() == 1
        for _ in range(2):
            with pytest.raises(ChannelEndedError):
                await channel.receive()

    asyncio.run(main())


def test_a_verb_hears_how_its_companion_has_failed() -> None:
    async def fail(verb: CompanionChannel) -> None:
        raise VerbError(ExitCode.PARTLY, f"no room for {await verb.receive()}")

    async def main() -> None:
        async with local_companion(fail) as companion:
            companion.send("a file")
            with pytest.raises(VerbError, match="no room for a file"):
                await companion.receive()

    asyncio.run(main())


def test_a_companion_that_fails_behind_its_verb_is_told() -> None:
    async def fail_late(verb: CompanionChannel) -> None:
        with pytest.raises(ChannelEndedError):
            await verb.receive()
        raise VerbError(ExitCode.PARTLY, "the rest is missing")

    async def main() -> None:
        with pytest.raises(VerbError, match="the rest is missing"):
            async with local_companion(fail_late):
                pass

    asyncio.run(main())
