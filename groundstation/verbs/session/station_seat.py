"""The seat of a verb in a station: one that runs, or that which the verb's own process has for it alone."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Coroutine, Sequence
from functools import cached_property
from typing import Any

from dialects import messages as m
from groundstation.station.operator_core import OperatorCore
from groundstation.station.verbs.running_verbs import RunningVerb, VerbMessage
from groundstation.station_socket.verb_run import STILL_WITHIN
from groundstation.verbs.common.endings import wait_for_ends
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.session.core import VerbCore
from link.core import Core, LinkReport, Received, RefusalListener

log = logging.getLogger(__name__)

END_WITHIN = 1.0
"""s for an interrupted verb to send its last messages: final neutrals take 0.25 s."""


class StationSeat:
    """Joins the core of a verb to a station, in the place of links.

    A mistake of the verb must not end the station: it ends the verb (`broken`).
    """

    def __init__(
        self,
        station: OperatorCore,
        core: VerbCore | Core,
        name: str,
        flush: Callable[[], None],
        *,
        needs_session: bool = False,
        follows: bool = False,
        silence: Callable[[float], float] = lambda now: 0.0,
        moves: bool = False,
        alone: bool = False,
        is_permitted: Callable[[float], bool] | None = None,
        speak: Callable[[], list[VerbMessage]] | None = None,
    ) -> None:
        """`flush` sends what the station has queued; `silence`: for how many s the shell of the verb was silent.

        `moves`, `is_permitted`: see RunningVerb. `alone`: the station is that of the verb's own process. `speak`
        returns what the verb sends now; None: what its VerbCore does.
        """
        self._verbs, self._core = station.verbs, core
        self._flush, self._silence = flush, silence
        self._speak = core.outbox.pop if isinstance(core, VerbCore) else speak
        self._verb = RunningVerb(
            name, needs_session, self, follows=follows, moves=moves, alone=alone, is_permitted=is_permitted
        )

    @cached_property
    def broken(self) -> asyncio.Future[None]:
        """Has what ends the verb: a mistake in it, or a demand that is refused."""
        return asyncio.get_running_loop().create_future()

    def join(self, now: float) -> None:
        """Begin: take what the station knows."""
        self._verbs.join(self._verb, now)
        self.tick(now)
        self._flush()

    async def run(self, work: Coroutine[Any, Any, int]) -> int:
        """Join, do the work of the verb, and leave; return its exit code. Raises what ends it.

        A verb that is cancelled, or whose demand is refused, gets END_WITHIN to end in order.
        """
        self.join(self._now)
        verb = asyncio.ensure_future(work)
        try:
            await asyncio.wait((verb, self.broken), return_when=asyncio.FIRST_COMPLETED)
            if self.broken.done():
                self.broken.result()
            return await verb
        finally:
            try:
                if verb.cancel():
                    await wait_for_ends({verb}, END_WITHIN)
                    if verb.done() and not verb.cancelled() and (error := verb.exception()):
                        log.info(
                            "%s: %s", self._verb.name, error
                        )  # as of a file that cannot be kept: its shell has ended
            finally:
                self.leave()

    def leave(self) -> None:
        """End: send what is left."""
        self.flush()
        self._verbs.leave(self._verb, self._now)
        self._flush()
        if self.broken.done():
            self.broken.exception()  # a verb that ends by itself has not read it

    def flush(self) -> None:
        """Send the messages of the verb now."""
        self.pass_on(self._now)
        self._flush()

    def pass_on(self, now: float) -> None:
        """Give the messages of the verb to the station, which sends them; later if the shell stands still."""
        if self._silence(now) > STILL_WITHIN:
            return
        for said in self._speak() if self._speak is not None else ():
            self._verbs.handle(self._verb, said, now)

    @property
    def _now(self) -> float:
        return asyncio.get_running_loop().time()

    # ---- VerbSeat (station/verbs/running_verbs.py) ----

    def deliver(self, received: Received, now: float) -> None:
        """Handle a message that the station has handled."""
        self._guard(lambda: self._core.receive(received, now))
        self.pass_on(now)

    def tick(self, now: float) -> None:
        """Tick, unless the shell stands still."""
        if self._silence(now) > STILL_WITHIN:
            return
        self._verbs.hear(self._verb, now - self._silence(now))
        self._guard(lambda: self._core.tick(now))
        self.pass_on(now)

    def report(self, reports: Sequence[LinkReport], now: float) -> None:
        """Handle the state of the links."""
        self._guard(lambda: self._core.observe(reports, now))

    def tell_refusal(self, message: m.Message, why: str, now: float) -> None:
        """Note that a message is not sent, because the role of the station does not allow it."""
        if isinstance(self._core, RefusalListener):
            core = self._core
            self._guard(lambda: core.handle_refused(message, why, now))

    def refuse(self, line: str) -> None:
        """End the verb: its demand is not sent any more."""
        self._break(VerbError(ExitCode.NOT_IN_CONTROL, line))

    # ---- own ----

    def _guard(self, step: Callable[[], object]) -> None:
        try:
            step()
        except Exception as error:
            self._break(error)

    def _break(self, error: Exception) -> None:
        if not self.broken.done():
            self.broken.set_exception(error)
