"""An agent, the operator's screen, a station and a simulated rover: an event loop whose clock is that of a World.

The agent's calls are run by the code of the station (verbs/agents); only the MCP client and the pipes are left out.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine
from contextlib import suppress
from itertools import count
from typing import Any, TypeVar

from groundstation.intents.agents import PermitProposal
from groundstation.intents.session import ReportKeyReleases
from groundstation.intents.union import AnyIntent
from groundstation.station.agents.proposals import ProposalStage
from groundstation.verbs.agents.agent_calls import AgentCalls
from groundstation.verbs.common.channel import CompanionChannel
from groundstation.verbs.session.core import VerbCore
from groundstation.verbs.session.session import VerbSession
from tests.test_stops import Drive
from tests.world_loop import WorldLoop

Value = TypeVar("Value")

PERIOD = 0.04
"""s between two repeats of the held key, and two signs of life of the agent."""


class AgentWorld(Drive):
    """A drive with a screen that can permit, and one agent."""

    def __init__(self, *, step: float = 0.005) -> None:
        super().__init__(session=7)
        self.world.step = step
        self.screen: str | None = "screen on pts/1"
        self.station.verbs.screen_that_drives = lambda: self.screen
        self.station.proposals.permitting_screen = lambda: self.screen
        self.notes: list[str] = []
        self.station.proposals.take_note = lambda now, text: self.notes.append(text)
        self.holds: int | None = None
        """Number of the proposal that a key permits; None: no key is held."""
        self.agent_lives = True
        self.answers: dict[int, dict[str, Any]] = {}
        self._held_since = self._permit_due = self._alive_due = 0.0
        self._numbers = count(1)
        self.channel = CompanionChannel(self._take)
        self.loop = WorldLoop(lambda: self.world.now, lambda: self.run(self.world.step))
        self.tell(ReportKeyReleases())
        self._agent: asyncio.Task[None] | None = None

    def run_agent(self, script: Coroutine[Any, Any, Value]) -> Value:
        """Run a script beside the agent's calls."""
        return self.loop.run_until_complete(self._with_agent(script))

    def close(self) -> None:
        """Close the loop, in which nothing of the agent runs any more."""
        left = asyncio.all_tasks(self.loop)
        self.loop.close()
        assert not left, "a task is destroyed before its end"

    async def _with_agent(self, script: Coroutine[Any, Any, Value]) -> Value:
        session = VerbSession(VerbCore(self.station, None), self.world.settle, lambda report: None)
        session.companion, session.program = self.channel, "mavhelm mcp (pid 1)"
        self._agent = asyncio.ensure_future(AgentCalls(session).run())
        try:
            return await script
        finally:
            self._agent.cancel()
            await asyncio.wait({self._agent})

    def end_agent(self) -> None:
        """Let the agent's program end."""
        self.channel.end()

    def _take(self, value: dict[str, Any]) -> None:
        self.answers[value["id"]] = value

    def call(self, tool: str, **arguments: Any) -> int:
        """Begin a call; return its number."""
        number = next(self._numbers)
        self.channel.push({"type": "call", "id": number, "tool": tool, "arguments": arguments})
        return number

    async def answer(self, number: int, within: float = 30.0) -> dict[str, Any]:
        """Wait for the answer of a call."""
        await self.see(lambda: number in self.answers, within)
        return self.answers[number]

    async def see(self, condition: Callable[[], object], within: float = 10.0) -> float:
        """Let time pass until a condition holds; return how long it took."""
        start = self.world.now
        while not condition():
            assert self.world.now - start < within, f"not within {within} s: {self.notes[-5:]}"
            await asyncio.sleep(self.world.step)
        return self.world.now - start

    async def insist(self, intent: AnyIntent, condition: Callable[[], bool]) -> None:
        """Let the operator do something again each second until it has an effect."""
        while not condition():
            self.tell(intent)
            with suppress(AssertionError):
                await self.see(condition, 1.0)

    def hold(self) -> None:
        """Press the key for the proposal that is shown, and hold it."""
        shown = self.station.proposals.shown
        self.holds, self._held_since = (0 if shown is None else shown.number), self.world.now

    def release(self) -> None:
        """Let the key go, on a terminal that does not report it."""
        self.holds = None

    @property
    def runs(self) -> bool:
        """Whether a proposal runs."""
        shown = self.station.proposals.shown
        return shown is not None and shown.stage is ProposalStage.RUNNING

    def _each(self, now: float) -> None:
        super()._each(now)
        if self.screen_lives and self.holds is not None and now >= self._permit_due:
            self._permit_due = now + PERIOD
            held = now - self._held_since
            if held >= 1.0:
                self.station.handle_intent(PermitProposal(self.holds, held), now)
        if self.agent_lives and now >= self._alive_due:
            self._alive_due = now + PERIOD
            self.channel.push({"type": "alive"})
