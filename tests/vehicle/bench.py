"""A rover on the bench in virtual time, with drivers that talk to it as the link would."""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from typing import TypeVar

from dialects import codec
from dialects import messages as m
from dialects.axes import Axes, build_manual_control
from dialects.enums import Autopilot, Command, Result, VehicleType
from dialects.modes import Mode
from link.core import Peer, Received
from vehicle.accessories.accessory_set import AccessorySet
from vehicle.accessories.output import AccessorySpec, PulseRange
from vehicle.accessories.simulated import SimulatedAccessory
from vehicle.camera.camera import Camera
from vehicle.commands.signing import Pairing
from vehicle.params import Params
from vehicle.readings import ComputerReadings, Readings
from vehicle.rover import Rover
from vehicle.safety.states import SafetyState
from vehicle.storage.logbook import LogRecorder
from vehicle.storage.plan_store import PlanStore

M = TypeVar("M", bound=m.Message)

CYCLE = 0.02
DRIVER, OTHER = 255, 254
AHEAD = Axes(throttle=1.0)
NEUTRAL = Axes()

MESSAGE_IDS = Rover(Params(), now=0.0).message_ids
"""What a link passes to the rover."""

BEAT = m.Heartbeat(VehicleType.GCS, Autopilot.INVALID, 0, 0, 4, 3)

EVERYTHING = Readings(
    roll=0.1, pitch=0.1, yaw=math.pi / 4, yaw_rate=0.0, velocity_north=0.5, velocity_east=0.5, speed=0.7,
    latitude=48.1, longitude=11.5, altitude=500.0, gps_fix=3, gps_satellites=12, gps_hdop=0.8,
    battery_voltage=12.0, battery_current=1.0, battery_remaining=0.9, wheel_speeds=(0.7, 0.7),
    computer=ComputerReadings(temperature=50.0, load=0.2),
)  # fmt: skip
"""A rover with every sensor."""


class Bench:
    """`now` moves only in `wait`, a cycle of 20 ms at a time; every message the rover sends must be encodable.

    A ground station that knows our dialect listens from the beginning: `station`, from where DRIVER speaks.
    """

    plans: PlanStore | None = None
    """What keeps its plans; a class of its own may have one."""

    recording: LogRecorder | None = None
    """What writes its logs."""

    pairing: Pairing | None = None
    """What keeps its keys."""

    camera: Camera | None = None
    """Its camera."""

    outputs: Sequence[AccessorySpec] = ()
    """Its relays and servos."""

    def __init__(self, now: float = 100.0, **params: float) -> None:
        self.now = now
        self.rack = AccessorySet(self.outputs)
        self.rack.open()
        self.logged: list[str] = []
        """The texts in the log of the daemon."""
        self.rover = Rover(
            Params(params),
            now=now,
            plan_store=self.plans,
            recording=self.recording,
            pairing=self.pairing,
            rack=self.rack,
            camera=self.camera,
            on_text=lambda severity, text: self.logged.append(text),
        )
        self.readings = Readings()
        self.sent: list[m.Message] = []
        self.peers: list[Peer | None] = []
        """Who alone got it; None for what went to several or to everybody."""
        self.texts: list[str] = []
        self._sequence = 0
        self._next_cycle = now
        self._met: set[Peer] = set()
        self.station = Peer(0, f"gcs {DRIVER}")
        self.meet()
        self.wait(CYCLE)

    @property
    def throttles(self) -> tuple[float, ...]:
        return self.rover.outputs.throttles

    @property
    def turning(self) -> bool:
        return any(self.throttles)

    @property
    def armed(self) -> bool:
        return self.rover.state is SafetyState.ARMED

    @property
    def mode(self) -> Mode:
        return Mode(self.newest(m.Heartbeat).custom_mode)

    def newest(self, kind: type[M]) -> M:
        return next(message for message in reversed(self.sent) if isinstance(message, kind))

    def all(self, kind: type[M]) -> list[M]:
        return [message for message in self.sent if isinstance(message, kind)]

    def say(self, message: m.Message, system: int = DRIVER, *, introduced: bool = True, sequence: int | None = None,
            address: Hashable = "", named: bool = False) -> None:  # fmt: skip
        """One message of a ground station, and what the rover answers. As on a link, the rest is not even decoded."""
        if type(message).id not in MESSAGE_IDS:
            return
        self._sequence = (self._sequence + 1) % 256 if sequence is None else sequence
        peer = Peer(0, address or f"gcs {system}")
        if introduced:
            self._introduce(peer, system)
        self._receive(Received(message, system, 190, self._sequence, peer, introduced, named))
        self._collect()

    def _introduce(self, peer: Peer, system: int) -> None:
        """Its first HEARTBEAT, where it has shown none yet."""
        if peer not in self._met:
            self._met.add(peer)
            self.rover.receive(Received(BEAT, system, 190, 0, peer, introduced=True), self.now)

    def meet(self, system: int = DRIVER) -> None:
        """A ground station shows that it is one of ours."""
        self.say(m.RoverOperatorPresence(1, 1, 0, 0, 0, 0, 0, 0), system)

    def heartbeat(self, system: int = DRIVER, *, introduced: bool = True) -> None:
        self.say(BEAT, system, introduced=introduced)

    def command(self, command: int, *params: float, system: int = DRIVER, target: int = 1, component: int = 1,
                introduced: bool = True) -> Result | None:  # fmt: skip
        """The rover's acknowledgement, None for silence."""
        before = len(self.all(m.CommandAck))
        one, two, three, four, five, six, seven = (*params, *(0.0,) * (7 - len(params)))
        message = m.CommandLong(target, component, command, 0, one, two, three, four, five, six, seven)
        self.say(message, system, introduced=introduced)
        acks = self.all(m.CommandAck)[before:]
        assert len(acks) <= 1
        if not acks:
            return None
        assert (acks[0].command, acks[0].target_system, acks[0].target_component) == (command, system, 190)
        return Result(acks[0].result)

    def stick(self, axes: Axes, system: int = DRIVER, target: int = 1) -> None:
        self.say(build_manual_control(axes, target), system)

    def arm(self, system: int = DRIVER, **kwargs: bool) -> Result | None:
        return self.command(Command.COMPONENT_ARM_DISARM, 1, system=system, **kwargs)

    def set_mode(self, mode: Mode, system: int = DRIVER) -> Result | None:
        return self.command(Command.DO_SET_MODE, 1, mode, system=system)

    def drive(self, axes: Axes = AHEAD) -> None:
        """Armed, neutral shown, and going: the danger that safety tests begin with."""
        assert self.arm() is Result.ACCEPTED
        self.wait(0.1, NEUTRAL)
        self.wait(1.0, axes)
        assert self.turning

    def wait(self, seconds: float, axes: Axes | None = None, period: float = 0.05, system: int = DRIVER) -> None:
        """Let time pass, with a driver that sends `axes` each `period` s, or a silent one."""
        end, due = self.now + seconds, self.now
        while self._next_cycle <= end + 1e-9:
            self.now = self._next_cycle
            if axes is not None and self.now >= due - 1e-9:
                due += period
                self.stick(axes, system)
            self.cycle()
        self.now = end

    def cycle(self) -> None:
        """One tick now; the next is a cycle later."""
        self._tick()
        self._collect()
        self._next_cycle = self.now + CYCLE

    def freeze(self, seconds: float) -> None:
        """The vehicle's process does not run for a while."""
        self.now += seconds
        self._next_cycle = self.now

    def _receive(self, received: Received) -> None:
        self.rover.receive(received, self.now)

    def _tick(self) -> None:
        self.rover.sense(self.readings, self.now)
        self.rover.tick(self.now)

    def _collect(self) -> None:
        for outgoing in self.rover.messages_to_send():
            codec.encode_payload(outgoing.message)
            self.sent.append(outgoing.message)
            self.peers.append(outgoing.peer)
            if isinstance(outgoing.message, m.StatusText):
                self._read(outgoing.message)

    def _read(self, message: m.StatusText) -> None:
        """Texts longer than a message come in chunks."""
        text = m.decode_text(message)
        if message.chunk_seq:
            self.texts[-1] += text
        else:
            self.texts.append(text)


class Equipped(Bench):
    """With a relay for each way to be safe, and a servo."""

    outputs = (
        AccessorySpec("relay", 0, SimulatedAccessory),
        AccessorySpec("relay", 1, SimulatedAccessory, until="end"),
        AccessorySpec("relay", 2, SimulatedAccessory, until="disarm"),
        AccessorySpec("servo", 9, SimulatedAccessory, pulses=PulseRange(1100, 1500, 1900)),
    )


def said(bench: Bench, part: str) -> bool:
    """Did the driver read this?"""
    return any(part in text for text in bench.texts)


def logged(bench: Bench, part: str) -> bool:
    """Is this in the log of the daemon?"""
    return any(part in text for text in bench.logged)
