"""What an agent proposes runs while a person holds a key, and never else: in virtual time, with the motors as truth."""

from __future__ import annotations

import asyncio
import math
import os
import random
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from dialects.modes import Mode
from groundstation.intents.agents import DeclineProposal, EndPermission, PermitProposal
from groundstation.intents.driving import ClearEmergencyStop, DriveKeyDown, EmergencyStop, Stop
from groundstation.intents.session import SetKeyGate
from groundstation.intents.vehicle import Arm, Disarm, SetMode
from groundstation.station.agents.proposals import LONGEST_WAIT, MOST_WAITING, NO_SCREEN
from groundstation.verbs.agents.agent_calls import MOST_CALLS
from groundstation.verbs.agents.tools import TOOLS, ToolEffect
from groundstation.verbs.main import build_parser, choose_action
from tests.agent_world import PERIOD, AgentWorld
from vehicle.safety.states import SafetyState

SEQUENCES = int(os.environ.get("MAVHELM_AGENT_SEQUENCES", "50"))
"""Random sequences of tools; 10,000 take ten minutes (docs/agents.md)."""
STOPS_WITHIN = 0.5
LONG = {"throttle": 60, "seconds": 8, "max_meters": 50, "reason": "look around"}


@pytest.fixture
def world() -> Iterator[AgentWorld]:
    world = AgentWorld()
    yield world
    world.close()


@pytest.fixture
def coarse() -> Iterator[AgentWorld]:
    world = AgentWorld(step=0.02)
    yield world
    world.close()


async def begin(world: AgentWorld) -> None:
    """Let the operator arm."""
    await world.see(lambda: world.station.snapshot(world.world.now, 0).vehicle is not None)
    await asyncio.sleep(2.0)
    world.tell(Arm(held=1.0))
    await world.see(lambda: world.rover.state is SafetyState.ARMED)
    await world.see(lambda: any(contact.state.armed for contact in world.station.fleet))


async def drive(world: AgentWorld, **arguments: Any) -> int:
    """Propose to drive, hold the key, and see the wheels turn."""
    number = world.call("drive", **{**LONG, **arguments})
    await world.see(lambda: world.station.proposals.shown)
    await asyncio.sleep(1.0)
    assert not world.runs
    world.hold()
    await world.see(lambda: world.power > 0.5)
    return number


def press(*intents: Any) -> Callable[[AgentWorld], None]:
    return lambda world: world.tell(*intents)


def set_attribute(name: str, value: object) -> Callable[[AgentWorld], None]:
    return lambda world: setattr(world, name, value)


WAYS: dict[str, Callable[[AgentWorld], object]] = {
    "the key is released": press(EndPermission()),
    "the key repeats no more": AgentWorld.release,
    "a drive key": press(DriveKeyDown("k", 0, 0)),
    "a stop key": press(Stop()),
    "the emergency stop": press(EmergencyStop()),
    "disarming": press(Disarm()),
    "the key that declines": press(DeclineProposal()),
    "another screen or a lost focus": press(SetKeyGate(False, "another screen is open")),
    "a screen that is frozen or killed": set_attribute("screen_lives", False),
    "no screen drives any more": set_attribute("screen", None),
    "the agent is silent": set_attribute("agent_lives", False),
    "the agent has ended": AgentWorld.end_agent,
    "a stop of an agent": lambda world: world.call("stop"),
}
"""What ends a proposal that runs."""


@pytest.mark.parametrize("way", WAYS)
def test_wheels_stop_within_half_a_second_of(world: AgentWorld, way: str) -> None:
    async def script() -> None:
        await begin(world)
        await drive(world)
        at = world.world.now
        WAYS[way](world)
        await world.see(lambda: not world.runs, STOPS_WITHIN)
        await world.see(lambda: world.power < 0.5, STOPS_WITHIN - (world.world.now - at))
        await world.see(lambda: world.power == 0, 1.0)
        world.screen_lives, world.screen, world.holds = True, "screen on pts/1", None
        await asyncio.sleep(3.0)
        assert world.power == 0

    world.run_agent(script())


def test_the_key_counts_under_a_screen_that_shows_it(world: AgentWorld) -> None:
    async def script() -> None:
        await begin(world)
        world.tell(SetKeyGate(False, "another screen is open"))
        world.call("drive", **LONG)
        await world.see(lambda: world.station.proposals.shown)
        world.hold()
        await asyncio.sleep(3.0)
        assert world.power == 0
        world.release()
        await asyncio.sleep(0.5)
        world.tell(SetKeyGate(False, "another screen is open", permits=True))
        world.hold()
        await world.see(lambda: world.power > 0.5)
        world.tell(SetKeyGate(False, "this window does not have the focus"))
        await world.see(lambda: world.power < 0.5, STOPS_WITHIN)
        await world.see(lambda: world.power == 0, 1.0)

    world.run_agent(script())


def test_time_and_distance_bound_it_with_the_key_held(world: AgentWorld) -> None:
    async def script() -> None:
        await begin(world)
        number = await drive(world, seconds=1.0)
        assert (await world.answer(number))["error"] in ("", "1 s are over")
        await world.see(lambda: world.power == 0, 1.0)
        world.release()
        number = await drive(world, max_meters=0.5)
        assert (await world.answer(number))["error"] == "0.5 m are covered"
        await world.see(lambda: world.power == 0, 1.0)
        await asyncio.sleep(2.0)
        assert world.power == 0, "a key that is still held permits nothing more"

    world.run_agent(script())


def test_a_held_key_permits_the_proposal_it_was_pressed_for(world: AgentWorld) -> None:
    async def script() -> None:
        await world.see(lambda: world.station.snapshot(world.world.now, 0).vehicle is not None)
        await asyncio.sleep(2.0)
        world.call("set_param", name="FS_TIMEOUT", value=3, reason="first")
        second = world.call("arm", reason="second")
        await world.see(lambda: world.station.proposals.shown)
        world.hold()
        await world.see(lambda: world.params["FS_TIMEOUT"] == 3)
        await asyncio.sleep(3.0)
        assert world.rover.state is not SafetyState.ARMED
        assert second not in world.answers

    world.run_agent(script())


def test_a_setting_that_waits_ends_with_its_call(world: AgentWorld) -> None:
    """The link is cut while a permitted set waits for its answer: once it is cancelled nothing repeats it."""

    def requests() -> bool:
        return any("VerbSession.request" in repr(task.get_coro()) for task in asyncio.all_tasks())

    async def script() -> None:
        await world.see(lambda: world.station.snapshot(world.world.now, 0).vehicle is not None)
        await asyncio.sleep(2.0)
        number = world.call("set_param", name="FS_TIMEOUT", value=3, reason="cut")
        await world.see(lambda: world.station.proposals.shown)
        world.hold()
        await world.see(requests)
        world.world.cut()
        await asyncio.sleep(0.1)
        assert requests()
        world.channel.push({"type": "cancel", "id": number})
        await world.see(lambda: not world.runs)
        world.release()
        await asyncio.sleep(1.0)
        assert not requests()

    world.run_agent(script())


def test_a_vehicle_that_drives_itself_gets_hold_on_release(world: AgentWorld) -> None:
    async def script() -> None:
        await begin(world)
        await asyncio.sleep(5.0)
        assert world.station.fleet.selected is not None
        where = world.station.fleet.selected.details.place
        assert where is not None
        world.call("goto", latitude=where.latitude + 0.001, longitude=where.longitude, seconds=60, max_meters=90,
                   reason="far away")  # fmt: skip
        await world.see(lambda: world.station.proposals.shown)
        world.hold()
        await world.see(lambda: mode_of(world) is Mode.GUIDED)
        await world.see(lambda: world.power > 0.1)
        world.release()
        await world.see(lambda: mode_of(world) is Mode.HOLD, STOPS_WITHIN)
        await world.see(lambda: world.power == 0, 1.0)

    world.run_agent(script())


def test_arming_and_settings_wait_for_the_key_and_are_noted(world: AgentWorld) -> None:
    async def script() -> None:
        await world.see(lambda: world.station.snapshot(world.world.now, 0).vehicle is not None)
        await asyncio.sleep(2.0)
        arming = world.call("arm", reason="ready to go")
        await world.see(lambda: world.station.proposals.shown)
        await asyncio.sleep(5.0)
        assert not is_armed(world)
        world.hold()
        assert (await world.answer(arming))["error"] == ""
        assert is_armed(world)
        lines = [line.text for line in world.station.log.build_lines(world.world.now, 0.0)]
        assert "agent 1: mavhelm mcp (pid 1) proposes: arm" in lines
        assert "agent 1: permitted by the key at the screen on pts/1" in lines
        assert "agent 1 reason: ready to go" in world.notes

    world.run_agent(script())


def test_without_a_screen_nothing_waits(world: AgentWorld) -> None:
    async def script() -> None:
        await world.see(lambda: world.station.snapshot(world.world.now, 0).vehicle is not None)
        world.screen = None
        assert (await world.answer(world.call("arm", reason="x")))["error"] == NO_SCREEN
        assert (await world.answer(world.call("status")))["error"] == ""

    world.run_agent(script())


def test_waiting_is_bounded_in_number_and_time(world: AgentWorld) -> None:
    async def script() -> None:
        await world.see(lambda: world.station.snapshot(world.world.now, 0).vehicle is not None)
        numbers = [world.call("arm", reason="x", wait_seconds=60) for _ in range(10_000)]
        await world.see(lambda: len(world.answers) == len(numbers) - MOST_WAITING, 60.0)
        refused = {each["error"] for each in world.answers.values()}
        assert refused == {
            f"{MOST_CALLS} calls run already: wait for their end",
            f"{MOST_WAITING} proposals wait already: wait for their end",
        }
        await world.see(lambda: len(world.answers) == len(numbers), LONGEST_WAIT + 1)
        assert {world.answers[number]["error"] for number in numbers} - refused == {"nobody has held the key in time"}
        assert world.rover.state is not SafetyState.ARMED

    world.run_agent(script())


BAD = {
    "an unknown tool": ("fly", {}, "no such tool"),
    "the emergency release": ("estop", {"clear": True}, "no such tool"),
    "escape codes": ("arm", {"reason": "\x1b[2Jok"}, "characters that cannot be printed"),
    "bidi characters": ("arm", {"reason": "ok \u202egnidloh"}, "characters that cannot be printed"),
    "a megabyte": ("arm", {"reason": "x" * 1_000_000}, "1000000 characters; 200 at most"),
    "a claim to be the operator": ("arm", {"reason": "x", "permitted_by": "operator"}, "permitted_by': no such"),
    "no reason": ("arm", {}, "reason is missing"),
    "NaN": ("drive", {**LONG, "throttle": math.nan}, "nan is not from -100 to 100"),
    "infinity": ("drive", {**LONG, "max_meters": math.inf}, "inf is not from 0.1 to 100"),
    "a list for a number": ("drive", {**LONG, "seconds": [1]}, "is not a number"),
    "true for a number": ("drive", {**LONG, "seconds": True}, "is not a number"),
    "an option for a name": ("get_params", {"pattern": "--all"}, "is not a name or a pattern"),
    "a file": ("get_params", {"pattern": "/etc/passwd"}, "is not a name or a pattern"),
    "a huge number": ("set_param", {"name": "FS_TIMEOUT", "value": 1e300, "reason": "x"}, "is not from"),
    "a vehicle that is not there": ("arm", {"reason": "x", "vehicle": 99}, "no vehicle 99 is heard"),
    "no arguments at all": ("arm", None, "the arguments are no object"),
}  # fmt: skip


def test_bad_input_is_one_clear_error(world: AgentWorld) -> None:
    async def script() -> None:
        await world.see(lambda: world.station.snapshot(world.world.now, 0).vehicle is not None)
        for value in (
            None,
            7,
            {},
            {"type": "call"},
            {"type": "call", "id": "x", "tool": 1},
            {"type": "cancel", "id": 99},
        ):
            world.channel.push(value)
        for name, (tool, arguments, error) in BAD.items():
            number = 10_000 + len(world.answers)
            world.channel.push({"type": "call", "id": number, "tool": tool, "arguments": arguments})
            said = (await world.answer(number))["error"]
            assert error in said, name
            assert len(said) < 200
            assert said.isprintable()
        assert (await world.answer(world.call("status")))["error"] == ""

    world.run_agent(script())


def test_reading_tools_and_stops_use_verbs_that_change_nothing() -> None:
    known = {"seconds": 1.0, "message": "ATTITUDE", "pattern": "FS_*"}
    for name, tool in TOOLS.items():
        if tool.effect is ToolEffect.PROPOSE or not (words := tool.words(known)):
            continue
        action = choose_action(words[0], build_parser(words[0]).parse_args(words[1:]))
        assert action.watches if tool.effect is ToolEffect.READ else action.stops, name
        assert action.companion is None, name


STOPS = [name for name, tool in TOOLS.items() if tool.effect is ToolEffect.STOP]
OTHERS = [*(name for name in TOOLS if name not in STOPS), "estop", "send"]


class Intruder:
    """Calls tools at random, with keys that permit nothing pressed at the screen meanwhile."""

    def __init__(self, world: AgentWorld, chance: random.Random) -> None:
        self._world, self._chance = world, chance

    async def act(self) -> None:
        """Make one sequence of up to six calls."""
        chance, world = self._chance, self._world
        for _ in range(chance.randint(1, 6)):
            number = world.call(chance.choice(STOPS if chance.random() < 0.02 else OTHERS), **self._arguments())
            await asyncio.sleep(chance.choice((0.0, 0.02, 0.1)))
            if world.station.proposals.shown is not None and chance.random() < 0.12:
                event = self._event()
                for _ in range(chance.randint(1, 15)):
                    world.tell(event)
                    await asyncio.sleep(PERIOD)
            if chance.random() < 0.2:
                world.channel.push({"type": "cancel", "id": number})
        world.tell(*(DeclineProposal() for _ in range(MOST_WAITING)))

    def _arguments(self) -> dict[str, Any]:
        chance = self._chance
        good: dict[str, Any] = {
            "reason": "x", "throttle": 80, "steering": -20, "seconds": chance.choice((0.5, 1, 2)), "max_meters": 5,
            "degrees": 90, "mode": chance.choice(("AUTO", "RTL", "MANUAL", "GUIDED", "HOLD")), "latitude": 0.001,
            "longitude": 0.001, "name": "FS_TIMEOUT", "value": chance.choice((1, 9)), "wait_seconds": 1,
            "message": "ATTITUDE", "pattern": "FS_TIMEOUT",
        }  # fmt: skip
        wild: tuple[Any, ...] = (math.nan, -math.inf, 1e308, "", "\x1b[A", "-v", None, True, [], {})
        return {
            name: chance.choice(wild) if chance.random() < 0.03 else value
            for name, value in good.items()
            if chance.random() < 0.97
        }

    def _event(self) -> Any:
        chance, shown = self._chance, self._world.station.proposals.shown
        number = 0 if shown is None else shown.number
        return chance.choice((
            PermitProposal(number, chance.choice((0.0, 0.5, 0.99, math.nan))),
            PermitProposal(number + chance.choice((-1, 1, 1000)), 5.0), EndPermission(), DeclineProposal(),
        ))  # fmt: skip


def is_armed(world: AgentWorld) -> bool:
    return world.rover.state is SafetyState.ARMED


def mode_of(world: AgentWorld) -> Mode:
    return world.rover._safety.mode


async def prepare(world: AgentWorld, *, armed: bool) -> None:
    """Let the operator undo the stops of the agent, so that the next call could move or arm the rover."""
    if world.rover.state is SafetyState.ESTOP:
        await world.insist(ClearEmergencyStop(held=1.0), lambda: world.rover.state is SafetyState.SAFE)
    if armed:
        await world.insist(Arm(held=1.0), lambda: world.rover.state is SafetyState.ARMED)
    else:
        await world.insist(Disarm(), lambda: world.rover.state is SafetyState.SAFE)
    await world.insist(SetMode("MANUAL"), lambda: mode_of(world) is Mode.MANUAL)


def settings_of(world: AgentWorld) -> dict[str, float]:
    return {name: world.params[name] for name in world.params}


def fitting(name: str, arguments: dict[str, Any]) -> dict[str, Any]:
    known = {each.name for each in TOOLS[name].all_arguments} if name in TOOLS else set(arguments)
    return {key: value for key, value in arguments.items() if key in known}


@pytest.mark.timeout(600 + SEQUENCES)
@pytest.mark.parametrize("armed", [False, True])
def test_without_a_held_key_nothing_moves_arms_or_changes(coarse: AgentWorld, armed: bool) -> None:
    world = coarse
    plain_call = world.call
    world.call = lambda tool, **arguments: plain_call(tool, **fitting(tool, arguments))  # type: ignore[method-assign]
    chance = random.Random(f"{armed} {SEQUENCES}")
    before = settings_of(world)

    async def script() -> None:
        await begin(world)
        await prepare(world, armed=armed)
        intruder = Intruder(world, chance)
        world.moved.clear()
        for _ in range(SEQUENCES // 2):
            await intruder.act()
            assert all(power == 0 for _, power in world.moved), "wheels turned"
            assert settings_of(world) == before, "a setting has changed"
            assert world.rover.state is not SafetyState.ARMED or armed, "armed"
            assert mode_of(world) in (Mode.MANUAL, Mode.HOLD)
            await prepare(world, armed=armed)
            world.moved.clear()
            world.answers.clear()
        if armed:  # the same world moves, and the other one arms, as soon as a key is held
            await drive(world)
            return
        world.call("arm", reason="x")
        await world.see(lambda: world.station.proposals.shown)
        world.hold()
        await world.see(lambda: is_armed(world))

    world.run_agent(script())
