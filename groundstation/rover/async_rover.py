"""AsyncRover: a vehicle for a program with asyncio. All angles are degrees, all else is SI."""

from __future__ import annotations

import asyncio
import os
from collections.abc import AsyncGenerator, Callable, Sequence
from types import TracebackType
from typing import Any, Self

from groundstation.rover.connection import ApiConnection, Outcome
from groundstation.rover.errors import Disconnected, InvalidCall, NoAnswer, RoverError
from groundstation.rover.telemetry import State, StateValues
from groundstation.sitl.sitl import SimulatorControl, free_port
from link.endpoint import parse_endpoint

LONGEST = 9.0
"""s that one call may drive: as `mavhelm drive`."""
SITL_WAIT = 10.0
"""s for a simulator to start."""


class AsyncRover(StateValues):
    """One vehicle, while `async with` runs.

    `endpoints`: as for `mavhelm`, such as "udpin:0.0.0.0:14550"; without one the ground station that runs here, or the
    endpoint used last. `vehicle`: its system id or name; needed if there are several. `wait`: s for its heartbeat.
    `stay_armed`: do not disarm at the end what this program has armed. Between two calls that drive,
    the demand is neutral.
    """

    def __init__(
        self, *endpoints: str, vehicle: int | str | None = None, wait: float = 10.0, stay_armed: bool = False
    ) -> None:
        self._endpoints, self._vehicle = list(endpoints), vehicle
        self._wait, self._stay_armed = wait, stay_armed
        self._simulator: SimulatorControl | None = None
        self._connection: ApiConnection | None = None
        self.waits: Callable[[], bool] = lambda: True
        """Whether the program waits for the call that drives; Rover sets it."""

    @classmethod
    def simulated(cls, *, stay_armed: bool = False) -> Self:
        """Return a simulated rover, which ends with the program."""
        rover = cls(vehicle=1, wait=SITL_WAIT, stay_armed=stay_armed)
        rover._simulator = SimulatorControl()
        return rover

    async def __aenter__(self) -> Self:
        """Connect."""
        await self.open()
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        """Stop, disarm and disconnect."""
        await self.close()

    async def open(self) -> None:
        """Connect, and wait for the vehicle. Raises NoVehicle, RoverError."""
        if self._simulator is not None:
            self._endpoints = [f"udpin:127.0.0.1:{free_port()}"]
            if problem := self._simulator.start([parse_endpoint(self._endpoints[0])]):
                raise RoverError(problem)
        arguments = [word for each in self._endpoints for word in ("-e", each)]
        arguments += ["--station", "never"] if self._simulator is not None else []
        arguments += [] if self._vehicle is None else ["-v", str(self._vehicle)]
        arguments += ["--stay-armed"] if self._stay_armed else []
        self._connection = connection = ApiConnection(("--wait", f"{self._wait:g}", *arguments))
        connection.waits = self.waits
        try:
            await connection.open()
        except BaseException:
            await self.close()
            raise

    async def close(self) -> None:
        """Send neutral, disarm what this program has armed, and disconnect."""
        connection, self._connection = self._connection, None
        if connection is not None:
            await connection.close()
        if self._simulator is not None:
            await asyncio.to_thread(self._simulator.close)

    async def settle(self) -> None:
        """Wait until calls that were cancelled have ended with neutral."""
        if self._connection is not None:
            await self._connection.settle()

    # ---- telemetry ----

    @property
    def state(self) -> State:
        """The newest state; ten come in a second. Raises Disconnected."""
        state = self._connected.state
        assert state is not None
        return state

    @property
    def texts(self) -> tuple[str, ...]:
        """The newest texts of the vehicle, at most 100."""
        return tuple(each.text for each in self._connected.texts)

    async def wait_for(self, condition: Callable[[State], bool], within: float) -> State:
        """Wait until a state fulfils a condition; return it. `within`: s. Raises NoAnswer."""
        try:
            async with asyncio.timeout(within):
                while not condition(self.state):
                    await self._connected.wait_for_state()
        except TimeoutError:
            raise NoAnswer(f"not so within {within:g} s") from None
        return self.state

    async def messages(self, name: str, hz: float | None = None) -> AsyncGenerator[dict[str, Any], None]:
        """Yield the fields of each message of a kind that arrives. `hz`: ask for this rate first, 0.001 to 200."""
        if hz is not None:
            await self.run("rate", name, f"{hz:g}")
        async for fields in self._connected.follow("watch", name):
            yield fields["fields"]

    # ---- driving ----

    async def arm(self, wait: float = 10.0) -> None:
        """Arm, once the vehicle is ready; `wait`: s for that."""
        await self.run("arm", "--wait", f"{wait:g}")

    async def disarm(self) -> None:
        """Disarm, repeated until the heartbeat reports it."""
        await self.run("disarm")

    async def stop(self) -> None:
        """Change to HOLD, repeated until the heartbeat reports it. It ends a call that drives."""
        await self.run("stop")

    async def estop(self) -> None:
        """Stop the motors and lock them, repeated until the vehicle reports it."""
        await self.run("estop")

    async def clear_estop(self) -> None:
        """Release the emergency stop."""
        await self.run("estop", "--clear")

    async def drive(self, throttle: float, steering: float = 0.0, *, seconds: float) -> None:
        """Drive by hand for up to 9 s, then neutral.

        `throttle`: -1 to 1, negative backwards; `steering`: -1 to 1, positive to the right. Raises NotInControl,
        Refused, LinkLost.
        """
        _need_demand(throttle, steering)
        if not 0 < seconds <= LONGEST:
            raise InvalidCall(f"{seconds!r} s is not above 0 and up to {LONGEST:g} s")
        words = ("--throttle", f"{100 * throttle:g}", "--steering", f"{100 * steering:g}", "--for", f"{seconds:g}")
        await self._connected.call("drive", *words, drives=True)

    async def turn(self, degrees: float, demand: float = 0.4) -> float:
        """Turn on the spot, then neutral; return by how many degrees it has turned. Positive is to the right.

        `demand`: above 0, up to 1. Raises Refused where the vehicle reports no heading or does not turn on the spot.
        """
        words = (f"--steering={100 * demand:g}", "--", f"{degrees:g}")
        outcome = await self._connected.call("turn", *words, drives=True)
        return float(outcome.fields["turned"])

    # ---- what the vehicle does by itself ----

    async def set_mode(self, name: str) -> None:
        """Change the mode; done when the heartbeat reports it."""
        await self.run("mode", name)

    async def goto(self, latitude: float, longitude: float) -> None:
        """Have the vehicle drive to a place by itself; done when it begins. It goes on when the program ends."""
        await self.run("goto", "--", f"{latitude:.7f}", f"{longitude:.7f}")

    async def home(self) -> None:
        """Have the vehicle drive home by itself; done when it begins. It goes on when the program ends."""
        await self.run("home")

    async def upload_plan(self, path: str | os.PathLike[str], kind: str = "mission") -> None:
        """Upload a .plan or .waypoints file. `kind`: mission, fence or rally."""
        await self.run(_need_kind(kind), "put", _absolute(path))

    async def download_plan(self, path: str | os.PathLike[str], kind: str = "mission") -> None:
        """Download a plan into a file, which is replaced. `kind`: mission, fence or rally."""
        await self.run(_need_kind(kind), "get", "--yes", _absolute(path))

    async def start_mission(self) -> None:
        """Start the mission, or go on with it. It goes on when the program ends."""
        await self.run("mission", "start")

    async def pause_mission(self) -> None:
        """Stop where the vehicle is; start_mission() goes on."""
        await self.run("mission", "pause")

    # ---- parameters, commands ----

    async def get_param(self, name: str) -> float:
        """Return a parameter as the vehicle reports it now. Raises Differs if there is none of this name."""
        outcome = await self.run("param", "get", name)
        return float(outcome.records[0]["param_value"])

    async def set_param(self, name: str, value: float) -> None:
        """Set a parameter; done when the vehicle reports the new value."""
        await self.run("param", "set", "--", name, repr(value))

    async def command(self, name: str, *params: float) -> None:
        """Send a MAV_CMD by its name, with up to 7 parameters; done when the vehicle has accepted."""
        await self.run("command", "--", name, *(f"{each:.9g}" for each in params))

    async def run(self, *words: str) -> Outcome:
        """Run any verb of `mavhelm` that works with a vehicle, such as `log list`. Raises RoverError."""
        return await self._connected.call(*words, drives=words[:1] in (("drive",), ("turn",)))

    @property
    def _connected(self) -> ApiConnection:
        if self._connection is None:
            raise Disconnected("this Rover is not connected: use it in `with`")
        return self._connection


def _need_demand(*values: float) -> None:
    for each in values:
        if not -1 <= each <= 1:
            raise InvalidCall(f"{each!r} is not a demand from -1 to 1")


def _need_kind(kind: str) -> str:
    kinds: Sequence[str] = ("mission", "fence", "rally")
    if kind not in kinds:
        raise InvalidCall(f"{kind!r} is not a plan: {', '.join(kinds)}")
    return kind


def _absolute(path: str | os.PathLike[str]) -> str:
    """Return a path that means the same to `mavhelm api` when this program has changed its folder."""
    return os.path.abspath(path)
