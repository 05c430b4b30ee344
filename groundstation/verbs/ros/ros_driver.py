"""RosDriver: messages of ROS drive the vehicle of a verb, as its keys and scripts do.

`push_twist` and `push_word` take what arrives, `remove` who has left; `run` drives until it is cancelled. The rules are
those of every driver: one program in control, neutral first, an armed vehicle in a mode that takes demands. A message
never arms and never changes the mode; that is `set_armed`. What ends driving is told once, and the publisher must show
neutral, or fall silent, before it drives again. Neutral follows however the program ends (driving.py, demand_guard.py).
"""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine, Hashable

from dialects.axes import NEUTRAL, Axes
from groundstation.ros.demand import RefusedDemandError, Scale
from groundstation.ros.sources import TWIST_SILENCE, WORD_SILENCE, DemandSources
from groundstation.vehicles.requests.requests import RequestState
from groundstation.verbs.common.exit_codes import VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.control.arm import arm
from groundstation.verbs.control.driving import begin_driving, disarm_vehicle, drive_fault, leave, need_control
from groundstation.verbs.session.session import VerbSession

LOOK_PERIOD = 0.02
"""s between looks whether the vehicle still takes demands: a tick of the session."""
NOTE_PERIOD, MOST_NOTES = 5.0, 5
"""s after which the same line is told again, and how many different ones are told meanwhile."""


class RosDriver:
    """The driver of one vehicle. All methods are called from the event loop; sources are any hashable keys."""

    def __init__(self, session: VerbSession, scale: Scale, output: Output) -> None:
        self._session = session
        self._scale = scale
        self._output = output
        self._told: dict[str, float] = {}
        self._arming = asyncio.Lock()
        self._armed_here = False
        self.sources = DemandSources()
        self.engaged = False
        """Demands are sent."""

    # ---- what arrives ----

    def push_twist(self, source: Hashable, linear: tuple[float, float, float], angular_z: float) -> None:
        """Handle the velocities of a Twist: m/s forward, left and up, rad/s."""
        try:
            axes = self._scale.of_twist(linear, angular_z)
        except RefusedDemandError as error:
            self._refuse(source, str(error))
        else:
            self._push(source, axes, TWIST_SILENCE)

    def push_word(self, source: Hashable, data: str) -> None:
        """Handle the data of a String."""
        try:
            axes = self._scale.of_word(data)
        except RefusedDemandError as error:
            self._refuse(source, str(error))
        else:
            self._push(source, axes, WORD_SILENCE)

    def remove(self, source: Hashable) -> None:
        """End the demand of a publisher that has left."""
        if self.sources.remove(source):
            self.note("the publisher that drove has left: neutral")
            self._send_now()

    def _push(self, source: Hashable, axes: Axes, silence: float) -> None:
        now = self._session.now
        before = self.sources.axes(now)
        if not self.sources.push(source, axes, silence, now):
            self.note("motion is ignored: another publisher drives, or this one must send zero first")
        elif not axes.neutral:
            self._session.contact.operator.inputs.add(now)
        if self.sources.axes(now) != before:
            self._send_now()

    def _refuse(self, source: Hashable, why: str) -> None:
        self.note(f"refused: {why}")
        self._push(source, NEUTRAL, TWIST_SILENCE)

    def _send_now(self) -> None:
        """Send a changed demand without waiting for the next tick."""
        if self.engaged:
            self._session.contact.tick(self._session.now)
            self._session.flush()

    # ---- driving ----

    async def run(self) -> None:
        """Drive while a publisher demands it and the vehicle takes it, until cancelled."""
        try:
            while True:
                await self._look()
                await asyncio.sleep(LOOK_PERIOD)
        finally:
            self._disengage()

    async def run_beside(self, *work: Coroutine[None, None, None], seconds: float | None = None) -> None:
        """Drive, and do the work beside it, until one of them fails, or for `seconds`.

        Then send the final neutrals, and disarm what this program has armed.
        """
        tasks = [asyncio.ensure_future(each) for each in (self.run(), *work)]
        try:
            async with asyncio.timeout(seconds):
                await asyncio.gather(*tasks)
        except TimeoutError:
            pass  # --for is over
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.wait(tasks)
            self.sources.stop()
            self.engaged = False
            await leave(self._session, disarm=self._armed_here)

    async def _look(self) -> None:
        session, now = self._session, self._session.now
        stood = session.core.standstill.last(now)
        if stood is not None:
            self._stop(f"this program stood still for {stood:.1f} s: neutral")
            session.core.standstill.forget()
        if self._arming.locked() or self.sources.axes(now).neutral:
            return
        fault = self._fault()
        if fault is not None:
            self._stop(f"{session.vehicle.name} {fault}")
        elif not self.engaged:
            async with self._arming:
                await self._engage(leave_hold=False)

    async def _engage(self, *, leave_hold: bool) -> str | None:
        """Begin to send demands; return why not."""
        try:
            need_control(self._session)
            await begin_driving(self._session, leave_hold=leave_hold)
        except VerbError as error:
            self._stop(str(error))
            return str(error)
        operator = self._session.contact.operator
        operator.inputs.add(self._session.now)
        operator.demand = self._demand
        self.engaged = True
        return None

    def _demand(self, now: float) -> Axes:
        return NEUTRAL if self._session.core.standstill.last(now) is not None else self.sources.axes(now)

    def _fault(self) -> str | None:
        """Return why a demand does not move the vehicle now, or None."""
        if not self._session.vehicle.monitor.is_alive(self._session.now):
            return "is not heard"
        fault = drive_fault(self._session)
        if fault is not None:
            return fault
        if self.engaged and self._session.contact.other_driver is not None:
            return f"is driven by GCS {self._session.contact.other_driver}"
        return None

    def _stop(self, why: str) -> None:
        self.note(f"{why}; the publisher must send zero before it drives")
        self.sources.stop()
        self._disengage()

    def _disengage(self) -> None:
        """End the demands; final neutral ones follow."""
        operator = self._session.contact.operator
        operator.demand = lambda _: NEUTRAL
        operator.demanding = False
        self.engaged = False

    # ---- arming ----

    async def set_armed(self, armed: bool, wait: float = 10.0) -> tuple[bool, str]:
        """Arm and take control in MANUAL, or disarm; return whether it is so, and a line. `wait`: s to be ready."""
        async with self._arming:
            return await (self._arm(wait) if armed else self._disarm())

    async def _arm(self, wait: float) -> tuple[bool, str]:
        state = self._session.vehicle
        self.sources.stop()
        self._disengage()
        try:
            need_control(self._session)
            if not state.armed:
                self._session.began = self._session.now  # `wait` counts from here
                report = await arm(self._session, wait, self._output)
                if report.state is not RequestState.ACCEPTED:
                    return False, report.text
                self._armed_here = True
        except VerbError as error:
            return False, str(error)
        why = await self._engage(leave_hold=True)
        return why is None, why or f"{state.name} is armed"

    async def _disarm(self) -> tuple[bool, str]:
        self.sources.stop()
        self._disengage()
        report = await disarm_vehicle(self._session)
        self._armed_here &= self._session.vehicle.armed
        done = report.state is RequestState.ACCEPTED
        return done, f"{self._session.vehicle.name} is disarmed" if done else report.text

    def note(self, text: str) -> None:
        """Tell something, not more often than once in NOTE_PERIOD."""
        now = self._session.now
        self._told = {each: at for each, at in self._told.items() if now - at < NOTE_PERIOD}
        if text not in self._told and len(self._told) < MOST_NOTES:
            self._told[text] = now
            self._output.note(text)
