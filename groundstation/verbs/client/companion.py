"""Runs the companion of a verb in the process of the user, where the verb itself may run in a station."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from typing import Any

from groundstation.verbs.common.channel import ChannelEndedError, CompanionChannel
from groundstation.verbs.common.exit_codes import ExitCode, VerbError

RunCompanion = Callable[[CompanionChannel], Awaitable[None]]


class RunningCompanion:
    """A companion. `send` takes what it sends to its verb, `ended` how it has failed before the end of the verb."""

    def __init__(
        self, run: RunCompanion, send: Callable[[Any], None], ended: Callable[[VerbError | None], None]
    ) -> None:
        self.channel = CompanionChannel(send)
        self._run, self._ended = run, ended
        self._verb_ended = False
        self._task = asyncio.ensure_future(self._run_to_the_end())

    async def finish(self) -> None:
        """End it behind its verb. Raises VerbError if it fails only then."""
        self._verb_ended = True
        self.channel.end()
        await self._task

    async def _run_to_the_end(self) -> None:
        failure = None
        try:
            await self._run(self.channel)
        except ChannelEndedError:
            pass
        except VerbError as error:
            failure = error
        except Exception as error:  # its verb must not wait for it
            failure = VerbError(ExitCode.BROKEN, f"{type(error).__name__}: {error}")
        if not self._verb_ended:
            self._ended(failure)
        elif failure is not None:
            raise failure


@asynccontextmanager
async def local_companion(run: RunCompanion | None) -> AsyncIterator[CompanionChannel]:
    """Run a companion, if there is one, beside its verb, which runs in this process, too; yield the verb's end."""
    ours = CompanionChannel()
    if run is None:
        yield ours
        return
    companion = RunningCompanion(run, ours.push, ours.end)
    ours.send = companion.channel.push
    try:
        yield ours
    finally:
        await companion.finish()
