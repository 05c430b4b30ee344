"""Signed ground stations, outsiders and thieves of frames: who drives, watches and stops, by the role of the key."""

from __future__ import annotations

import pytest

from dialects import codec
from dialects import messages as m
from dialects.axes import Axes
from dialects.enums import Command, Result
from dialects.modes import Mode
from link.protocol.signing_guard import SigningGuard, SigningPolicy
from link.signing.clock import TICKS
from link.signing.keys import SigningKey
from link.signing.role import SigningRole
from link.signing.signature import SecretHash
from link.signing.signing import Signing
from tests.link.signing.signed import DRIVER, NOON, NOW, WATCHER, keep
from tests.vehicle.wires import BOOT, Program, SessionProgram, Wires, drive_fully
from vehicle.config.signing import SigningSettings, build_policy
from vehicle.drive.roles import UNSIGNED

AHEAD, NEUTRAL = Axes(throttle=1.0), Axes()
DRIVES_ONLY = SigningKey("phone", SigningRole.DRIVE, bytes(range(32)))
OPEN = build_policy(SigningSettings(), private=False)
"""A link that a whole network reaches, as the default has it."""
STOPS = [(Command.COMPONENT_ARM_DISARM, (0,)), (Command.DO_SET_SAFETY_SWITCH_STATE, (0,)),
         (Command.DO_FLIGHTTERMINATION, (1,)), (Command.DO_SET_MODE, (1, Mode.HOLD)),
         (Command.DO_PAUSE_CONTINUE, (0,))]  # fmt: skip


def signing() -> Signing:
    return keep(DRIVER, WATCHER, DRIVES_ONLY, now=BOOT)


def guarded(policy: SigningPolicy = OPEN, links: int = 1) -> Wires:
    wires, shared = Wires(links), signing()
    for index, channel in enumerate(wires.channels):
        channel.guard = SigningGuard(shared, policy, index)
    return wires


class _Signs(Program):
    """Signs what it sends, with the time of the wires."""

    key = DRIVER
    link_id = 0

    def send(self, message: m.Message, *, lost: bool = False) -> bytes:
        frame = codec.frame_to_sign(type(message).id, codec.encode_payload(message), self.number, *self.ids)
        stamp = max(NOW + int((self.wires.now - BOOT) * TICKS), getattr(self, "_stamp", 0) + 1)
        self._stamp = stamp
        data = SecretHash(self.key.secret).sign(frame, self.link_id, stamp)
        self.number = (self.number + 1) & 0xFF
        self.frames.append((self.wires.now, data))
        if not lost:
            self.wires.put(data, self.address, self.link, self.delay)
        return data


class SignedProgram(_Signs):
    """A ground station of another make."""


class SignedSession(_Signs, SessionProgram):
    """Ours."""


@pytest.mark.parametrize("kind", [SignedProgram, SignedSession])
def test_a_signed_driver_drives_and_its_silence_stops(kind: type[Program]) -> None:
    wires = guarded(SigningPolicy(unsigned=None))
    drive_fully(kind, wires)
    wires.wait(1.5)
    assert not wires.turning


def test_the_prearm_checks_tell_who_has_no_key() -> None:
    wires = guarded()
    outsider, driver = Program(wires, "elsewhere", ids=(254, 190)), SignedProgram(wires)
    for each in (outsider, driver):
        each.hold(1.0, None)
        assert each.command(Command.RUN_PREARM_CHECKS) is Result.ACCEPTED
    wires.wait(0.5)
    assert outsider.text(f"PreArm: {UNSIGNED}")
    assert driver.text("PreArm: ready to arm")
    assert not driver.text(UNSIGNED)


@pytest.mark.parametrize("kind", [Program, SessionProgram])
def test_an_outsider_in_the_network_moves_nothing_and_may_watch(kind: type[Program]) -> None:
    wires = guarded()
    outsider = kind(wires, "elsewhere")
    outsider.hold(1.0, None)
    assert outsider.arm() is Result.DENIED
    assert outsider.set_mode(Mode.MANUAL) is Result.DENIED
    assert outsider.command(Command.DO_MOTOR_TEST, 1, 0, 30, 2) is Result.DENIED
    assert outsider.command(Command.PREFLIGHT_REBOOT_SHUTDOWN, 1) is Result.DENIED
    assert outsider.command(Command.DO_SET_RELAY, 0, 1) is Result.DENIED
    assert outsider.command(Command.REQUEST_OPERATOR_CONTROL, 1) is Result.DENIED
    assert outsider.command(Command.REQUEST_MESSAGE, m.AutopilotVersion.id) is Result.ACCEPTED
    outsider.send(m.ParamSet(1, 1, b"SPEED_MAX", 0.1, 9))
    outsider.hold(2.0, AHEAD)
    assert not wires.armed
    assert not wires.turning
    assert wires.rover._params["SPEED_MAX"] != pytest.approx(0.1)
    assert wires.rover._control.ownership.driver is None
    assert outsider.text(f"COMPONENT_ARM_DISARM refused: {UNSIGNED}")


@pytest.mark.parametrize("kind", [SignedProgram, SignedSession])
@pytest.mark.parametrize("address", ["gcs", "elsewhere"])
@pytest.mark.parametrize("policy", [OPEN, SigningPolicy(unsigned=None, open_stops=True)])
def test_outsider_with_drivers_ids_neither_drives_nor_clashes(
    kind: type[Program], address: str, policy: SigningPolicy
) -> None:
    """Without signing a forger who counts as the driver stops the vehicle (docs/safety.md, U2)."""
    wires = guarded(policy)
    driver = drive_fully(kind, wires)
    forger = Program(wires, address, number=driver.number)

    def each(now: float) -> None:
        forger.step(Axes(throttle=-1.0))
        driver.step(AHEAD)
        assert wires.throttle > 0.9

    wires.wait(3.0, each)
    assert not wires.said("Two programs")
    assert not wires.said("Another program uses your ids")


@pytest.mark.parametrize("kind", [SignedProgram, SignedSession])
def test_frames_of_the_driver_that_come_again_move_nothing(kind: type[Program]) -> None:
    """All of them, in order, at the driver's address, after it has gone: D4 and U4 without signing."""
    wires = guarded(SigningPolicy(unsigned=None, open_stops=True), links=2)
    driver = drive_fully(kind, wires)
    frames = [data for _, data in driver.frames]
    wires.wait(6.0)
    for place, link in (("gcs", 0), ("elsewhere", 0), ("gcs", 1)):
        for data in frames:
            wires.put(data, place, link)
            wires.wait(0.02)
            assert not wires.turning
    assert wires.rover.state.value != "armed" or not wires.turning


def test_a_replay_of_yesterdays_arming_does_not_arm() -> None:
    wires = guarded()
    driver = SignedProgram(wires)
    driver.hold(1.0, None)
    assert driver.arm() is Result.ACCEPTED
    driver.disarm()
    frames = [data for _, data in driver.frames[:-1]]
    for kept in (True, False):
        again = guarded()
        memory = wires.channels[0].guard._signing.memory(wires.now) if kept else None  # type: ignore[union-attr]
        later = keep(DRIVER, wall=NOON + 86_400, memory=memory, now=BOOT)
        again.channels[0].guard = SigningGuard(later, OPEN, 0)
        for data in frames:
            again.put(data, "gcs")
        again.wait(0.1)
        assert not again.armed


@pytest.mark.parametrize(("command", "params"), STOPS)
@pytest.mark.parametrize("kind", [Program, SignedProgram])
@pytest.mark.parametrize("policy", [OPEN, SigningPolicy(unsigned=None, open_stops=True)])
def test_everybody_may_stop(
    command: Command, params: tuple[float, ...], kind: type[Program], policy: SigningPolicy
) -> None:
    wires = guarded(policy)
    driver = drive_fully(SignedSession, wires)
    other = kind(wires, "elsewhere", ids=(254, 190))
    if isinstance(other, SignedProgram):
        other.key = WATCHER
    assert other.command(command, *params) is Result.ACCEPTED
    driver.hold(1.5, AHEAD)
    assert not wires.turning


@pytest.mark.parametrize(("command", "params"), STOPS)
def test_with_closed_stops_only_key_holders_stop(command: Command, params: tuple[float, ...]) -> None:
    wires = guarded(build_policy(SigningSettings(required=True, open_stops=False), private=False))
    driver = drive_fully(SignedSession, wires)
    outsider = Program(wires, "elsewhere", ids=(254, 190))
    outsider.command(command, *params)
    driver.hold(1.0, AHEAD)
    assert wires.throttle > 0.9
    watcher = SignedProgram(wires, "elsewhere", ids=(253, 190))
    watcher.key = WATCHER
    watcher.command(command, *params)
    driver.hold(1.5, AHEAD)
    assert not wires.turning


def test_a_watch_key_does_not_drive_and_a_drive_key_not_set_up() -> None:
    wires = guarded()
    watcher, driver = SignedProgram(wires, "a", ids=(254, 190)), SignedProgram(wires, "b", ids=(253, 190))
    watcher.key, driver.key = WATCHER, DRIVES_ONLY
    watcher.hold(1.0, None)
    assert watcher.arm() is Result.DENIED
    assert watcher.text("COMPONENT_ARM_DISARM refused: its key may only watch")
    driver.hold(1.0, None)
    assert driver.arm() is Result.ACCEPTED
    assert driver.set_mode(Mode.HOLD) is Result.ACCEPTED
    driver.disarm()
    for command in (Command.PREFLIGHT_STORAGE, Command.PREFLIGHT_CALIBRATION, Command.PREFLIGHT_REBOOT_SHUTDOWN):
        assert driver.command(command, 1) is Result.DENIED
    driver.send(m.ParamSet(1, 1, b"SPEED_MAX", 0.5, 9))
    driver.send(m.MissionCount(1, 1, 1))
    driver.hold(0.5, None)
    assert wires.rover._params["SPEED_MAX"] != pytest.approx(0.5)
    assert driver.text("change refused: its key may drive but not set up")
    assert driver.text("mission not changed: its key may drive but not set up")


def test_the_fence_is_switched_off_by_a_key_to_set_up_only() -> None:
    wires = guarded()
    phone, laptop = SignedProgram(wires, "phone", ids=(254, 190)), SignedProgram(wires)
    phone.key = DRIVES_ONLY
    for each in (phone, laptop):
        each.hold(1.0, None)
    assert phone.command(Command.DO_FENCE_ENABLE, 1) is Result.ACCEPTED
    assert phone.command(Command.DO_FENCE_ENABLE, 0) is Result.DENIED
    assert phone.text("its key may drive but not set up")
    assert laptop.command(Command.DO_FENCE_ENABLE, 0) is Result.ACCEPTED


def test_watcher_with_the_drivers_ids_and_address_moves_nothing() -> None:
    """It may stop, as everybody may; its demands are not the driver's, however they are numbered."""
    wires = guarded()
    driver = drive_fully(SignedProgram, wires)
    driver.hold(0.5, NEUTRAL)
    thief = SignedProgram(wires, number=driver.number)
    thief.key, thief.link_id = WATCHER, 9

    def each(now: float) -> None:
        thief.demand(AHEAD)
        driver.step(NEUTRAL)

    wires.wait(0.2)
    wires.wait(2.0, each)
    assert not wires.turning


def test_a_driver_whose_key_is_withdrawn_stops() -> None:
    wires = guarded()
    shared = wires.channels[0].guard._signing  # type: ignore[union-attr]
    driver = drive_fully(SignedSession, wires)
    shared.set_ring(shared.ring.remove(DRIVER.name))
    driver.hold(1.5, AHEAD)
    assert not wires.turning


@pytest.mark.parametrize(
    ("settings", "private", "unsigned", "stops"),
    [
        (SigningSettings(), True, SigningRole.SET_UP, True),
        (SigningSettings(), False, SigningRole.WATCH, True),
        (SigningSettings(allow_unsigned=True), False, SigningRole.SET_UP, True),
        (SigningSettings(required=True), True, None, True),
        (SigningSettings(required=True), False, None, True),
        (SigningSettings(required=True, open_stops=False), False, None, False),
    ],
)
def test_what_the_file_makes_of_a_link(
    settings: SigningSettings, private: bool, unsigned: SigningRole | None, stops: bool
) -> None:
    assert build_policy(settings, private=private) == SigningPolicy(unsigned, open_stops=stops)
