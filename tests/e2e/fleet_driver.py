"""A fleet with one vehicle that alice drives, on this computer or with two routers in networks of their own."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path

import zenoh

from dialects import messages as m
from dialects.axes import Axes
from dialects.enums import Command
from dialects.modes import Mode
from link.bridge.fleet.fleet_file import FILE, read_fleet_file
from link.endpoint import parse_endpoint
from link.fleet.config import load_config
from tests.e2e.fleet_programs import LOCALHOST, FleetWires, RouterProcess, make_fleet
from tests.e2e.namespaces import Namespaces
from tests.vehicle.wires import SessionProgram
from tests.waits import PATIENCE

AHEAD, NEUTRAL = Axes(throttle=1.0), Axes()
MAN_TIMEOUT = 0.45
TRY = 5.0
"""s for a demand to turn the wheels at full throttle; then the driver begins anew."""
FALL = 0.55
"""s from the end of the demand to wheels at rest: docs/safety.md allows 1 s from the last demand."""
ROLES = {"rover1": "vehicle", "rover2": "vehicle", "alice": "drive", "bob": "watch"}
ROUTERS, VEHICLE = ("first", "second"), "vehicle"
"""Names of the namespaces."""


@dataclass(frozen=True, slots=True)
class Outage:
    """What came of an outage that began while the wheels turned; s."""

    stood: float
    """From its begin to wheels at rest."""
    silence: float
    """The longest time without a frame of the vehicle, from its begin until the driver is obeyed again."""
    back: float
    """From its end to the next frame of the vehicle."""
    obeyed: float
    """From that frame to a command that is obeyed."""
    moved: bool
    """The wheels turned after its end, though every demand since its middle was neutral."""


class Driver(SessionProgram):
    """An operator of the fleet with a session, who echoes the time of the vehicle."""

    def build(self, axes: Axes | None, *, age: float = 0.02) -> m.RoverOperatorPresence:
        proof = super().build(axes)
        proof.echo_time_boot_ms = self.wires.boot_ms[1] if self.wires.boot_ms else 0  # type: ignore[attr-defined]
        return proof

    def step(self, axes: Axes | None, rate: float = 20.0, *, lost: bool = False) -> None:
        """As SessionProgram; a vehicle that comes back is greeted, as by our ground station."""
        met: set[object] = self.wires.met  # type: ignore[attr-defined]
        if self.address in met:
            met.discard(self.address)
            self.beat()
        super().step(axes, rate, lost=lost)


class Fleet:
    """One vehicle that alice drives."""

    def __init__(
        self, folder: Path, stack: ExitStack, networks: Namespaces | None = None, *, quic: bool = False
    ) -> None:
        """With `networks` there are two routers, linked, and the vehicle is in a network of its own."""
        hosts = [networks.address(each) for each in ROUTERS] if networks else LOCALHOST
        self.folder = make_fleet(folder, hosts, quic=quic, **ROLES)
        self.routers = [*self._start_routers(stack, networks)]
        self.router = self.routers[0]
        self.wires = FleetWires(folder, self.folder, stack, within=networks.within(VEHICLE) if networks else ())
        self.driver = Driver(self.wires, "alice")  # type: ignore[arg-type]
        self.wires.transport("alice")
        self.wires.until(lambda: self.wires.boot_ms is not None, lambda now: self.driver.step(None))

    def _start_routers(self, stack: ExitStack, networks: Namespaces | None) -> Iterator[RouterProcess]:
        if networks is None:
            yield RouterProcess(self.folder, stack)
            return
        first = read_fleet_file(self.folder / FILE).routers[0]
        for name, link in zip(ROUTERS, ("", first), strict=True):
            yield RouterProcess(self.folder, stack, within=networks.within(name), link=link)

    def drive(self) -> None:
        """Begin a test: armed, at full throttle, whatever the one before has left."""
        for router in self.routers:
            router.restore()
        self.rest()
        self.accelerate()

    def accelerate(self) -> None:
        """Drive at full throttle. What a failsafe has ended on a late machine is begun anew, as a person does."""
        deadline = self.wires.now + PATIENCE
        while not self.wires.vehicle.at_full():
            assert self.wires.now < deadline, self.wires.vehicle.errors.read_text()
            while not self.armed():
                assert self.wires.now < deadline, "it does not arm"
                self.driver.arm()
                self.wires.wait(0.3, lambda now: self.driver.step(NEUTRAL))
            self.regain()
            self.rest()  # a demand counts once neutral was shown in the mode
            with suppress(AssertionError):
                self.wires.until(self.wires.vehicle.at_full, lambda now: self.driver.step(AHEAD), within=TRY)

    def rest(self) -> None:
        self.wires.wait(0.6, lambda now: self.driver.step(NEUTRAL))

    def regain(self) -> float:
        """Choose MANUAL, as a person does after a stop; return when the vehicle obeyed."""
        before, due = len(self.wires.sent), 0.0
        deadline = self.wires.now + PATIENCE
        while not any(_accepts(each) for who, each in self.wires.sent[before:] if who == "alice"):
            assert self.wires.now < deadline, "it is not obeyed"
            if self.wires.now >= due:
                due = self.wires.now + 0.1
                self.driver.set_mode(Mode.MANUAL)
            self.wires.wait(0.02, lambda now: self.driver.step(NEUTRAL))
        return self.wires.now

    def armed(self) -> bool:
        beats = [each for who, each in self.wires.sent[-2000:] if isinstance(each, m.Heartbeat)]
        return bool(beats) and bool(beats[-1].base_mode & 128)

    def next_frame(self) -> float:
        """Wait for the next frame of the vehicle; return when it came: the link is back."""
        before = len(self.wires.sent)
        self.wires.until(lambda: len(self.wires.sent) > before, lambda now: self.driver.step(NEUTRAL))
        return self.wires.now

    def suffer(self, seconds: float, begin: Callable[[], object], end: Callable[[], object]) -> Outage:
        """Go through an outage: full throttle in its first half, neutral demands from its middle on."""
        self.drive()
        wires = self.wires
        begun, wires.longest_silence = wires.now, 0.0
        begin()
        wires.wait(seconds / 2, lambda now: self.driver.step(AHEAD))
        wires.wait(seconds / 2, lambda now: self.driver.step(NEUTRAL))
        end()
        ended = wires.now
        _, stood = wires.vehicle.falls_and_stops_after(begun)
        back = self.next_frame()
        obeyed, silence = self.regain(), wires.longest_silence
        wires.wait(1.0, lambda now: self.driver.step(NEUTRAL))
        return Outage(stood, silence, back - ended, obeyed - back, wires.vehicle.moved_since(ended))

    @property
    def router_in_use(self) -> RouterProcess:
        """Return the router that the driver is connected to, as its log says."""
        arrived, gone = "operator alice (drive) from", "operator alice (drive) has gone"
        logs = {each: each.log.read_text() for each in self.routers}
        return next(each for each, text in logs.items() if text.count(arrived) > text.count(gone))

    def session(self, name: str, *, waits: bool = False) -> zenoh.Session:
        """Return a session with the certificate of a member, and no manners. `waits`: its puts wait for room."""
        is_vehicle = "rover" in name
        endpoint = parse_endpoint(f"zenoh:{self.folder}/{name}.json5/farm{f'/{name}' if is_vehicle else ''}")
        config = load_config(endpoint).zenoh
        if waits:
            config.insert_json5("qos/publication", "[]")
        return zenoh.open(config)


def _accepts(message: m.Message) -> bool:
    return isinstance(message, m.CommandAck) and (message.command, message.result) == (Command.DO_SET_MODE, 0)
