"""Rover: a vehicle for a program without asyncio. It runs an AsyncRover in a thread of its own."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Callable, Coroutine, Iterator
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self, TypeVar

from groundstation.rover.api_process import ApiProcess
from groundstation.rover.errors import Disconnected
from groundstation.rover.state_values import StateValues

if TYPE_CHECKING:
    from groundstation.rover.async_rover import AsyncRover
    from groundstation.rover.connection import Outcome
    from groundstation.rover.mission import Fence, Mission, Rally
    from groundstation.rover.rover_thread import RoverThread
    from groundstation.rover.telemetry import State

Result = TypeVar("Result")


class RoverParams:
    """The parameters of a vehicle: `rover.params["FS_TIMEOUT"]` asks for one, an assignment sets it."""

    def __init__(self, rover: Rover) -> None:
        self._rover = rover

    def __getitem__(self, name: str) -> float:
        """Return it as the vehicle reports it now. Raises Differs if there is none of this name."""
        return self._rover.call(lambda rover: rover.get_param(name))

    def __setitem__(self, name: str, value: float) -> None:
        """Set it; done when the vehicle reports the new value. Raises Refused, NoAnswer."""
        self._rover.call(lambda rover: rover.set_param(name, value))


class Rover(StateValues):
    """One vehicle, inside `with`: see AsyncRover for the arguments.

    Every call blocks until it is done. The thread that has called is what keeps a call driving: if it hangs, or its
    process is stopped or killed, the vehicle is neutral after 0.5 s at most.
    """

    def __init__(
        self, *endpoints: str, vehicle: int | str | None = None, wait: float = 10.0, stay_armed: bool = False
    ) -> None:
        self._use(ApiProcess(endpoints, vehicle, wait, stay_armed=stay_armed))

    @classmethod
    def simulated(cls, *, stay_armed: bool = False) -> Self:
        """Return a simulated rover, which ends with the program."""
        rover = cls.__new__(cls)
        rover._use(ApiProcess(vehicle=1, stay_armed=stay_armed, simulated=True))
        return rover

    def _use(self, process: ApiProcess) -> None:
        self._process = process
        self._thread: RoverThread | None = None
        self._pid = os.getpid()

    def __enter__(self) -> Self:
        """Connect."""
        self.open()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        """Stop, disarm and disconnect."""
        self.close()

    def __del__(self) -> None:
        """Disconnect a Rover that was opened without `with` and is forgotten."""
        if not sys.is_finalizing():  # then its thread is gone, and the end of the process ends the connection
            with contextlib.suppress(Exception):
                self.close()

    def open(self) -> None:
        """Connect, and wait for the vehicle. Raises NoVehicle, RoverError."""
        if self._thread is not None:
            return
        self._process.start()
        from groundstation.rover.rover_thread import RoverThread  # with asyncio, while the process starts

        self._thread = RoverThread(self._process)
        try:
            self.call(lambda rover: rover.open())
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Send neutral, disarm what this program has armed, and disconnect."""
        thread = self._thread
        if thread is not None and os.getpid() == self._pid:
            self._thread = None
            thread.close()

    def call(self, start: Callable[[AsyncRover], Coroutine[Any, Any, Result]]) -> Result:
        """Run a coroutine of AsyncRover, and wait for it here; an exception here, as of Ctrl-C, cancels it."""
        return self._running.call(start)

    @property
    def _running(self) -> RoverThread:
        if os.getpid() != self._pid:
            raise Disconnected("this Rover belongs to the process that has opened it: a fork opens its own")
        if self._thread is None:
            raise Disconnected("this Rover is not connected: use it in `with`")
        return self._thread

    # ---- telemetry ----

    @property
    def state(self) -> State:
        """The newest state; ten come in a second. Raises Disconnected."""
        return self._running.rover.state

    @property
    def texts(self) -> tuple[str, ...]:
        """The newest texts of the vehicle, at most 100."""
        return self._running.rover.texts

    def wait_for(self, condition: Callable[[State], bool], within: float) -> State:
        """Wait until a state fulfils a condition; return it. `within`: s. Raises NoAnswer."""
        return self.call(lambda rover: rover.wait_for(condition, within))

    def messages(self, name: str, hz: float | None = None) -> Iterator[dict[str, Any]]:
        """Yield the fields of each message of a kind that arrives. `hz`: ask for this rate first, 0.001 to 200."""
        source = self._running.rover.messages(name, hz)
        try:
            while (fields := self.call(lambda _: anext(source, None))) is not None:
                yield fields
        finally:
            self.call(lambda _: source.aclose())

    # ---- driving ----

    def arm(self, wait: float = 10.0) -> None:
        """Arm, once the vehicle is ready; `wait`: s for that."""
        self.call(lambda rover: rover.arm(wait))

    def disarm(self) -> None:
        """Disarm, repeated until the heartbeat reports it."""
        self.call(lambda rover: rover.disarm())

    def stop(self) -> None:
        """Change to HOLD, repeated until the heartbeat reports it. It ends a call that drives."""
        self.call(lambda rover: rover.stop())

    def estop(self) -> None:
        """Stop the motors and lock them, repeated until the vehicle reports it."""
        self.call(lambda rover: rover.estop())

    def clear_estop(self) -> None:
        """Release the emergency stop."""
        self.call(lambda rover: rover.clear_estop())

    def drive(
        self, throttle: float, steering: float = 0.0, *, side: float = 0.0, climb: float = 0.0, seconds: float
    ) -> None:
        """Drive by hand for up to 9 s, then neutral.

        `throttle`: -1 to 1, negative backwards; `steering`: -1 to 1, positive to the right. Of a copter also `side`,
        positive to the right, and `climb`, negative for down. Raises NotInControl, Refused, LinkLost.
        """
        self.call(lambda rover: rover.drive(throttle, steering, side=side, climb=climb, seconds=seconds))

    def turn(self, degrees: float, demand: float = 0.4) -> float:
        """Turn on the spot, then neutral; return by how many degrees it has turned. Positive is to the right.

        `demand`: above 0, up to 1. Raises Refused where the vehicle reports no heading or does not turn on the spot.
        """
        return self.call(lambda rover: rover.turn(degrees, demand))

    def take_off(self, altitude: float) -> None:
        """Have a copter that is armed take off to an altitude above the ground, 1 to 30 m; done when it is reached.

        It hovers until the program ends; then its own failsafe for a lost station lands it or flies it home.
        """
        self.call(lambda rover: rover.take_off(altitude))

    def land(self) -> None:
        """Have a copter land where it is; done when it reports that it lands. It disarms itself on the ground."""
        self.call(lambda rover: rover.land())

    # ---- what the vehicle does by itself ----

    def set_mode(self, name: str) -> None:
        """Change the mode; done when the heartbeat reports it."""
        self.call(lambda rover: rover.set_mode(name))

    def goto(self, latitude: float, longitude: float) -> None:
        """Have the vehicle drive to a place by itself; done when it begins. It goes on when the program ends."""
        self.call(lambda rover: rover.goto(latitude, longitude))

    def home(self) -> None:
        """Have the vehicle drive home by itself; done when it begins. It goes on when the program ends."""
        self.call(lambda rover: rover.home())

    @property
    def mission(self) -> Mission:
        """The mission, downloaded now; an assignment uploads one, or clears it if it has no items."""
        from groundstation.rover.mission import Mission

        return self.call(lambda rover: rover.download(Mission))

    @mission.setter
    def mission(self, mission: Mission) -> None:
        self.call(lambda rover: rover.upload(mission))

    @property
    def fence(self) -> Fence:
        """The fence, likewise."""
        from groundstation.rover.mission import Fence

        return self.call(lambda rover: rover.download(Fence))

    @fence.setter
    def fence(self, fence: Fence) -> None:
        self.call(lambda rover: rover.upload(fence))

    @property
    def rally(self) -> Rally:
        """The rally points, likewise."""
        from groundstation.rover.mission import Rally

        return self.call(lambda rover: rover.download(Rally))

    @rally.setter
    def rally(self, rally: Rally) -> None:
        self.call(lambda rover: rover.upload(rally))

    def start_mission(self) -> None:
        """Start the mission, or go on with it. It goes on when the program ends."""
        self.call(lambda rover: rover.start_mission())

    def pause_mission(self) -> None:
        """Stop where the vehicle is; start_mission() goes on."""
        self.call(lambda rover: rover.pause_mission())

    # ---- parameters, commands ----

    @property
    def params(self) -> RoverParams:
        """The parameters of the vehicle: `params["FS_TIMEOUT"] = 2`."""
        return RoverParams(self)

    def command(self, name: str, *params: float) -> None:
        """Send a MAV_CMD by its name, with up to 7 parameters; done when the vehicle has accepted."""
        self.call(lambda rover: rover.command(name, *params))

    def run(self, *words: str) -> Outcome:
        """Run any verb of `mavhelm` that works with a vehicle, such as `log list`. Raises RoverError."""
        return self.call(lambda rover: rover.run(*words))
