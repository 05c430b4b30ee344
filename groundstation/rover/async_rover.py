"""AsyncRover: a vehicle for a program with asyncio. All angles are degrees, all else is SI."""

from __future__ import annotations

import asyncio
import os
import tempfile
from collections.abc import AsyncGenerator, Callable
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self, TypeVar

from groundstation.rover.api_process import ApiProcess
from groundstation.rover.connection import ApiConnection, Outcome
from groundstation.rover.errors import Disconnected, InvalidCall, NoAnswer
from groundstation.rover.state_values import StateValues
from groundstation.rover.telemetry import State

if TYPE_CHECKING:
    from groundstation.rover.mission import Fence, Mission, PlanItems, Rally

    Plan = TypeVar("Plan", bound=PlanItems)

LONGEST = 9.0
"""s that one call may drive: as `mavhelm drive`."""
PLANS = "mavhelm-plan-"
"""What the folders begin with in which plans pass between this program and its verbs."""


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
        self._process = ApiProcess(endpoints, vehicle, wait, stay_armed=stay_armed)
        self._connection: ApiConnection | None = None

    @classmethod
    def simulated(cls, *, stay_armed: bool = False) -> Self:
        """Return a simulated rover, which ends with the program."""
        return cls.of(ApiProcess(vehicle=1, stay_armed=stay_armed, simulated=True))

    @classmethod
    def of(cls, process: ApiProcess) -> Self:
        """Return one for a process that may run already."""
        rover = cls()
        rover._process = process
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
        self._connection = connection = ApiConnection(self._process)
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
        await asyncio.to_thread(self._process.close)

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

    async def drive(
        self, throttle: float, steering: float = 0.0, *, side: float = 0.0, climb: float = 0.0, seconds: float
    ) -> None:
        """Drive by hand for up to 9 s, then neutral.

        `throttle`: -1 to 1, negative backwards; `steering`: -1 to 1, positive to the right. Of a copter also `side`,
        positive to the right, and `climb`, negative for down. Raises NotInControl, Refused, LinkLost.
        """
        _need_demand(throttle, steering, side, climb)
        if not 0 < seconds <= LONGEST:
            raise InvalidCall(f"{seconds!r} s is not above 0 and up to {LONGEST:g} s")
        demand = {"--throttle": throttle, "--steering": steering, "--side": side, "--climb": climb}
        words = [f"{option}={100 * value:g}" for option, value in demand.items()]
        await self._connected.call("drive", *words, "--for", f"{seconds:g}", drives=True)

    async def turn(self, degrees: float, demand: float = 0.4) -> float:
        """Turn on the spot, then neutral; return by how many degrees it has turned. Positive is to the right.

        `demand`: above 0, up to 1. Raises Refused where the vehicle reports no heading or does not turn on the spot.
        """
        words = (f"--steering={100 * demand:g}", "--", f"{degrees:g}")
        outcome = await self._connected.call("turn", *words, drives=True)
        return float(outcome.fields["turned"])

    async def take_off(self, altitude: float) -> None:
        """Have a copter that is armed take off to an altitude above the ground, 1 to 30 m; done when it is reached.

        It hovers until the program ends; then its own failsafe for a lost station lands it or flies it home.
        """
        await self._connected.call("takeoff", f"{altitude:g}", drives=True)

    async def land(self) -> None:
        """Have a copter land where it is; done when it reports that it lands. It disarms itself on the ground."""
        await self.run("land")

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

    async def upload(self, plan: Mission | Fence | Rally) -> None:
        """Upload a plan; done when the vehicle has taken all of it. One without items clears the vehicle's."""
        if not plan.items:
            await self.run(plan.verb, "clear")
            return
        with tempfile.TemporaryDirectory(prefix=PLANS) as folder:
            path = os.path.join(folder, "upload.plan")
            plan.save(path)
            await self.run(plan.verb, "put", path)

    async def download(self, kind: type[Plan]) -> Plan:
        """Return the plan of the vehicle. `kind`: Mission, Fence or Rally."""
        with tempfile.TemporaryDirectory(prefix=PLANS) as folder:
            path = os.path.join(folder, "download.plan")
            outcome = await self.run(kind.verb, "get", path)
            return kind.load(path) if outcome.fields["items"] else kind()

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
        return await self._connected.call(*words, drives=words[:1] in (("drive",), ("takeoff",), ("turn",)))

    @property
    def _connected(self) -> ApiConnection:
        if self._connection is None:
            raise Disconnected("this Rover is not connected: use it in `with`")
        return self._connection


def _need_demand(*values: float) -> None:
    for each in values:
        if not -1 <= each <= 1:
            raise InvalidCall(f"{each!r} is not a demand from -1 to 1")
