"""The core of a verb that runs in the process of a station, and the seat there of such a core."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence

from dialects import codec
from dialects import messages as m
from groundstation.station.operator_core import OperatorCore
from groundstation.station.verbs.running_verbs import Verb
from groundstation.station_socket.verb_run import STILL_WITHIN
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.session.core import VerbCore
from link.core import Core, LinkReport, Received, RefusalListener
from link.protocol.log_tap import LogTap


class StationCore(VerbCore):
    """The core of a verb over the vehicles of a station, which has heard them. `wanted` as for VerbCore."""

    def __init__(self, station: OperatorCore, wanted: int | str | None) -> None:
        super().__init__(station, wanted)
        self.has_heard_all = True

    def receive(self, received: Received, now: float) -> None:
        """Handle one message, which the station has handled."""
        self.station.services.collect(now)  # what this message has ended
        super().receive(received, now)

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Take the vehicles that the station knows, and the reports of its links."""
        self.add_vehicles(now)
        super().observe(reports, now)

    def tick(self, now: float) -> None:
        """Send heartbeats, repeat what is overdue."""
        self.standstill.record_report(now)
        self.add_vehicles(now)
        super().tick(now)

    def record(self, log_tap: LogTap) -> None:
        """Have all that the station hears recorded, as frames without signatures. To be called before it joins."""

        def take(received: Received, now: float) -> None:
            number, place = type(received.message).id, (received.system, received.component)
            raw = codec.frame(number, codec.encode_payload(received.message), received.sequence, *place)
            log_tap.record_received([(number, *place, received.sequence, raw)], received.peer.link, now)

        self.taps.append(take)


class StationSeat:
    """Joins the core of a verb to a station, in the place of links.

    A mistake of the verb must not end the station: it ends the verb (`broken`).
    """

    def __init__(
        self,
        station: OperatorCore,
        core: Core,
        name: str,
        flush: Callable[[], None],
        *,
        needs_session: bool = False,
        follows: bool = False,
        silence: Callable[[float], float] = lambda now: 0.0,
    ) -> None:
        """`flush` sends what the station has queued; `silence`: for how many s the shell of the verb was silent."""
        self.broken: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        """Has what ends the verb: a mistake in it, or a demand that is refused."""
        self._verbs, self._core = station.verbs, core
        self._flush, self._silence = flush, silence
        self._verb = Verb(name, needs_session, self, follows=follows)

    def join(self) -> None:
        """Begin: take what the station knows."""
        self._verbs.join(self._verb, self._now)
        self.tick(self._now)
        self._flush()

    def leave(self) -> None:
        """End: send what is left."""
        self.flush()
        self._verbs.leave(self._verb, self._now)
        self._flush()
        if self.broken.done():
            self.broken.exception()  # a verb that ends by itself has not read it

    def flush(self) -> None:
        """Send the messages of the verb now."""
        self._pass_on(self._now)
        self._flush()

    @property
    def _now(self) -> float:
        return asyncio.get_running_loop().time()

    # ---- VerbSeat (station/verbs/running_verbs.py) ----

    def deliver(self, received: Received, now: float) -> None:
        """Handle a message that the station has handled."""
        self._guard(lambda: self._core.receive(received, now))
        self._pass_on(now)

    def tick(self, now: float) -> None:
        """Tick, unless the shell stands still."""
        if self._silence(now) > STILL_WITHIN:
            return
        self._verbs.hear(self._verb, now - self._silence(now))
        self._guard(lambda: self._core.tick(now))
        self._pass_on(now)

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

    def _pass_on(self, now: float) -> None:
        """Give the messages of the verb to the station, which sends them; later if the shell stands still."""
        if self._silence(now) > STILL_WITHIN:
            return
        for outgoing in self._core.messages_to_send():
            self._verbs.handle(self._verb, outgoing.message, now)

    def _guard(self, step: Callable[[], object]) -> None:
        try:
            step()
        except Exception as error:
            self._break(error)

    def _break(self, error: Exception) -> None:
        if not self.broken.done():
            self.broken.set_exception(error)
