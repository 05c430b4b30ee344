"""Both ends in one process and in virtual time: cores joined through channels and lossy pipes."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, field

from dialects.messages import Message
from link.core import Core, EarlyActor, Outgoing, RestingCore, SendGuard, SendListener, TimeTeller
from link.protocol.channel import Channel
from link.runner import REPORT_PERIOD
from link.transport.memory import LossyPipe


@dataclass
class Host:
    """A core with its one channel, driven as the runner would."""

    core: Core
    channel: Channel
    period: float
    tick_due: float = 0.0
    report_due: float = 0.0
    sent: list[tuple[float, Message]] = field(default_factory=list)
    sent_at: dict[int, float] = field(default_factory=dict)
    """Sequence number -> when it was sent last."""
    frozen: bool = False
    """As after SIGSTOP: it neither receives nor acts."""
    listener: SendListener | None = field(init=False)
    """The core, if it wants to know what was sent. Checked once, because isinstance() of a protocol is slow."""
    guard: SendGuard | None = field(init=False)
    """The core, if it decides at the last moment what is sent."""
    early: EarlyActor | None = field(init=False)
    """The core, if it may have something to do between two ticks."""
    resting: RestingCore | None = field(init=False)
    """The core, if it may need fewer ticks."""
    rest: float | None = None
    """s between the ticks that it needs now; None: all."""

    def __post_init__(self) -> None:
        self.listener = self.core if isinstance(self.core, SendListener) else None
        self.guard = self.core if isinstance(self.core, SendGuard) else None
        self.early = self.core if isinstance(self.core, EarlyActor) else None
        self.resting = self.core if isinstance(self.core, RestingCore) else None

    def advance(self, now: float) -> None:
        """Do what the runner does when time passes."""
        if self.frozen:
            return
        if now < self.tick_due:
            if self.early is not None and (due := self.early.due_at) is not None and now >= due:
                self.early.act(now)
            return
        if now >= self.report_due:
            self.report_due = now + REPORT_PERIOD
            self.channel.expire_peers(now)
            self.core.observe([self.channel.report(now=now)], now)
        self.core.tick(now)
        self.rest = self.resting.rest_period if self.resting is not None else None
        self.tick_due = max(self.tick_due + (self.period if self.rest is None else self.rest), now)

    def receive(self, data: bytes, address: Hashable, now: float) -> None:
        """Do what the runner does when data arrives."""
        if self.frozen:
            return
        for received in self.channel.receive(data, address, now):
            self.core.receive(received, now)
        for peer in self.channel.pop_untimely():
            if isinstance(self.core, TimeTeller):
                self.core.tell_time(peer, now)
        self.shorten_rest(now)

    def shorten_rest(self, now: float) -> None:
        """Tick at once if the core has got something to do."""
        if self.rest is not None and self.resting is not None:
            rest = self.resting.rest_period
            if rest is None or rest < self.rest:
                self.rest, self.tick_due = None, now

    def pop_frames(self, now: float, to: Hashable) -> list[bytes]:
        """Return the frames to send to an address; those to others are lost."""
        frames: list[bytes] = []
        outbox: list[Outgoing] = [] if self.frozen else self.core.messages_to_send()
        for outgoing in outbox:
            if self.guard is not None and not self.guard.may_send(outgoing.message, now):
                continue
            self.sent.append((now, outgoing.message))
            for data, address, sequence in self.channel.send(outgoing, now=now):
                self.sent_at[sequence] = now
                if address == to:
                    frames.append(data)
                if self.listener is not None:
                    self.listener.handle_sent(outgoing.message, sequence, now)
        return frames


class World:
    """Two hosts, `near` (a ground station) and `far` (a vehicle), and the two directions between them.

    Time starts at `now` and moves in steps of `step` s; every step delivers, ticks and sends, as the real loop does.
    """

    def __init__(
        self,
        near: Core,
        far: Core,
        *,
        near_ids: tuple[int, int] = (255, 190),
        far_ids: tuple[int, int] = (1, 1),
        period: float = 0.02,
        up: LossyPipe[bytes] | None = None,
        down: LossyPipe[bytes] | None = None,
        now: float = 100.0,
        step: float = 0.005,
    ) -> None:
        self.now = now
        self.step = step
        self.up = up or LossyPipe[bytes]()
        self.down = down or LossyPipe[bytes]()
        self.near = Host(near, self._channel("near", near_ids, "far"), period)
        self.far = Host(far, self._channel("far", far_ids, "near"), period)
        self.near_address: Hashable = "near"
        """Where the far end sees the near one; another one is that of a program that roams."""
        self._start = now
        self._steps = 0

    @staticmethod
    def _channel(name: str, ids: tuple[int, int], target: str) -> Channel:
        return Channel(name, 0, system=ids[0], component=ids[1], target=target)

    def run(self, seconds: float, each: Callable[[float], None] | None = None) -> None:
        """Let `seconds` pass; `each` is called once a step with the time, after everything else."""
        for _ in range(round(seconds / self.step)):
            self._steps += 1
            self.now = self._start + self._steps * self.step
            self._one_step()
            if each:
                each(self.now)

    def run_until(self, condition: Callable[[], bool], within: float) -> float:
        """Let time pass until `condition`; return how long it took. Raises AssertionError if it takes longer."""
        start = self.now
        while not condition():
            assert self.now - start < within, f"not within {within} s"
            self.run(self.step)
        return self.now - start

    def cut(self, cut: bool = True) -> None:
        """Cut both directions, or connect them again."""
        self.up.cut = self.down.cut = cut

    def settle(self) -> None:
        """Send what the cores have, without letting time pass: for intents that come between two steps."""
        self._exchange()
        self.near.shorten_rest(self.now)
        self.far.shorten_rest(self.now)

    def _one_step(self) -> None:
        for data in self.down.receive(self.now):
            self.near.receive(data, "far", self.now)
        for data in self.up.receive(self.now):
            self.far.receive(data, self.near_address, self.now)
        self.near.advance(self.now)
        self.far.advance(self.now)
        self._exchange()

    def _exchange(self) -> None:
        for data in self.near.pop_frames(self.now, "far"):
            self.up.send(data, self.now)
        for data in self.far.pop_frames(self.now, self.near_address):
            self.down.send(data, self.now)
