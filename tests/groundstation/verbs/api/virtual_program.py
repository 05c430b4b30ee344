"""A program that calls `mavhelm api`, and our rover, joined by lossy pipes in an event loop with virtual time."""

from __future__ import annotations

import argparse
import asyncio
import itertools
import math
from collections.abc import Callable, Coroutine
from typing import Any, TypeVar

import msgspec

from groundstation.rover.protocol import WAITING_PERIOD
from groundstation.verbs.api.program_calls import DRIVING, ProgramCalls
from groundstation.verbs.common.channel import CompanionChannel
from groundstation.verbs.main import build_parser, choose_action
from groundstation.verbs.session.core import VerbCore
from groundstation.verbs.session.session import VerbSession
from groundstation.verbs.session.station_seat import StationSeat
from link.transport.memory import LossyPipe
from tests.world import World
from tests.world_loop import WorldLoop
from vehicle.control_loop import ControlLoop
from vehicle.motors.simulated import SimulatedMotors
from vehicle.params import Params
from vehicle.rover import Rover
from vehicle.sim.body import SimulatedBody

STEP = 0.01
"""s of the world between two rounds of the loop."""
IDS = (254, 190)
RAMPED_DOWN = 0.8
"""s behind the end of a call until power is 0: where all neutrals are lost, a demand is stale after 0.45 s
(MAN_TIMEOUT), and the ramp from full power takes 0.33 s."""
Result = TypeVar("Result")


class VirtualProgram:
    """A program with one rover."""

    def __init__(self, loss: float, seed: int) -> None:
        self.rover, self.motors = Rover(Params({}), now=100.0), SimulatedMotors()
        self.core = VerbCore.alone(IDS, 1, 7, now=100.0)
        self.seat = StationSeat(self.core.station, self.core, "a program", lambda: None, needs_session=True, alone=True)
        up: LossyPipe[bytes] = LossyPipe(loss=loss, seed=seed)
        down: LossyPipe[bytes] = LossyPipe(loss=loss, seed=seed + 1)
        self.pipes = (up, down)
        motors = self.motors
        vehicle = ControlLoop(self.rover, motors, SimulatedBody(lambda: motors.outputs))
        self.world = World(self.core.station, vehicle, near_ids=IDS, up=up, down=down)
        self.driving = False
        self._drove_at = -math.inf
        self._power = 0.0
        self.driven = 0
        """Calls during which a wheel has turned."""
        self.strays: list[float] = []
        """When power grew outside of a call that drives, or was left RAMPED_DOWN behind its end."""
        self._turned = False
        self._answers: asyncio.Queue[Any] = asyncio.Queue()
        self._numbers = itertools.count(1)
        self.loop = WorldLoop(lambda: self.world.now, lambda: self.world.run(STEP, self._look))

    def run(self, program: Callable[[VirtualProgram], Coroutine[Any, Any, None]]) -> None:
        """Run a program, and end it in order."""
        try:
            self.loop.run_until_complete(self._run(program))
        finally:
            self.loop.close()

    @property
    def turning(self) -> bool:
        """Whether a wheel gets power."""
        return any(self.motors.outputs)

    async def call(self, words: tuple[str, ...], waits: float = 60.0) -> dict[str, Any]:
        """Call, and return how it ended; say for `waits` s that the program waits, then be silent."""
        number, began = next(self._numbers), self.loop.time()
        options = build_parser(words[0]).parse_args(words[1:])
        prepare = choose_action(words[0], options).prepare
        self.driving, self._turned = words[0] in DRIVING, False
        self.session.companion.push(
            {"type": "call", "id": number, "words": list(words), "given": prepare and prepare(options)}
        )
        while True:
            if self.loop.time() - began < waits:
                self.session.companion.push({"type": "waiting"})
            try:
                async with asyncio.timeout(WAITING_PERIOD):
                    while (answer := await self._answers.get())["type"] != "ended":
                        pass
            except TimeoutError:
                continue
            self.driven += self._turned
            self.driving = False
            assert answer["id"] == number
            return dict(answer)

    def _look(self, now: float) -> None:
        power, before = max(map(abs, self.motors.outputs)), self._power
        self._power = power
        self._turned |= power > 0
        if self.driving:
            self._drove_at = now
        elif power > before or (power and now - self._drove_at > RAMPED_DOWN):
            self.strays.append(now)

    async def _run(self, program: Callable[[VirtualProgram], Coroutine[Any, Any, None]]) -> None:
        self.session = session = VerbSession(self.core, self.seat.flush, lambda report: None)
        session.companion = CompanionChannel(lambda value: self._answers.put_nowait(msgspec.to_builtins(value)))
        work = asyncio.ensure_future(self.seat.run(self._serve(session)))
        await program(self)
        session.companion.end()
        await work

    async def _serve(self, session: VerbSession) -> int:
        await session.find_vehicle(10.0, 1)
        await session.prove_session()
        await ProgramCalls(session, argparse.Namespace(stay_armed=False)).run()
        return 0
