"""The core and the session of a verb that runs in the process of a station, over the vehicles of its OperatorCore."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence

from dialects import codec
from dialects import messages as m
from groundstation.station.operator_core import OperatorCore
from groundstation.station.relay.verb_relay import Verb
from groundstation.station_socket.verb_run import STILL_WITHIN
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.session.core import VerbCore
from link.core import LinkReport, Received
from link.protocol.log_tap import LogTap


class StationCore(VerbCore):
    """The core of a verb in a station, which has heard all vehicles and owns the links. `wanted` as for VerbCore.

    A mistake of the verb must not end the station: it ends the verb (`broken`).
    """

    def __init__(
        self,
        station: OperatorCore,
        wanted: int | str | None,
        name: str,
        flush: Callable[[], None],
        *,
        takes_part: bool = False,
        follows: bool = False,
        silence: Callable[[float], float] = lambda now: 0.0,
    ) -> None:
        """`flush` sends what the station has queued; `silence`: for how many s the shell of the verb was silent."""
        super().__init__(station, wanted)
        self.has_heard_all = True
        self.broken: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        """Has what ends the verb: a mistake in it, or a demand that is refused."""
        self._flush, self._silence = flush, silence
        self._verb = Verb(
            name, takes_part, self._deliver, self._report, self._refuse_demand, follows=follows, runs_here=True,
            tell_refusal=self._take_refusal, tick=self._run_tick,
        )  # fmt: skip

    def join(self) -> None:
        """Begin: take what the station knows."""
        now = self._now
        self.add_vehicles(now)
        self.station.relay.join(self._verb, now)
        self._run_tick(now)
        self._flush()

    def leave(self) -> None:
        """End: send what is left."""
        self.flush()
        self.station.relay.leave(self._verb, self._now)
        self._flush()
        if self.broken.done():
            self.broken.exception()  # a verb that ends by itself has not read it

    def flush(self) -> None:
        """Send the messages of the verb now."""
        self._pass_on(self._now)
        self._flush()

    def record(self, log_tap: LogTap) -> None:
        """Have all that the station hears recorded, as frames without signatures. To be called before `join`."""

        def take(received: Received, now: float) -> None:
            number, place = type(received.message).id, (received.system, received.component)
            raw = codec.frame(number, codec.encode_payload(received.message), received.sequence, *place)
            log_tap.record_received([(number, *place, received.sequence, raw)], received.peer.link, now)

        self.taps.append(take)

    @property
    def _now(self) -> float:
        return asyncio.get_running_loop().time()

    def _deliver(self, batch: Sequence[Received]) -> None:
        now = self._now
        self._guard(lambda: self._receive_all(batch, now))
        self._pass_on(now)

    def _receive_all(self, batch: Sequence[Received], now: float) -> None:
        self.station.services.collect(now)  # what this message has ended
        for received in batch:
            self.hear(received, now)

    def _run_tick(self, now: float) -> None:
        """Tick, unless the shell stands still."""
        self.standstill.record_report(now)
        if self._silence(now) > STILL_WITHIN:
            return
        self.station.relay.hear(self._verb, now - self._silence(now))
        self._guard(lambda: self.add_vehicles(now))
        self._guard(lambda: self.tick(now))
        self._pass_on(now)

    def _report(self, reports: Sequence[LinkReport]) -> None:
        self.observe(reports, self._now)

    def _take_refusal(self, message: m.Message, why: str) -> None:
        self._guard(lambda: self.handle_refused(message, why, self._now))

    def _refuse_demand(self, line: str) -> None:
        """End the verb: its demand is not sent any more."""
        self._break(VerbError(ExitCode.NOT_IN_CONTROL, line))

    def _pass_on(self, now: float) -> None:
        """Give the messages of the verb to the station, which sends them; later if the shell stands still."""
        if self._silence(now) > STILL_WITHIN:
            return
        for outgoing in self.messages_to_send():
            self.station.relay.handle(self._verb, outgoing.message, now)

    def _guard(self, step: Callable[[], object]) -> None:
        try:
            step()
        except Exception as error:
            self._break(error)

    def _break(self, error: Exception) -> None:
        if not self.broken.done():
            self.broken.set_exception(error)
