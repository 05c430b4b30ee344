"""Two rovers on one link: one is driven, the other is left in peace, and changing over stops the first."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Command
from groundstation.input.keymap import KEYMAPS, KeyEvent, Keymap
from groundstation.intents.driving import DriveKeyDown, DriveKeyUp, EmergencyStop, Stop
from groundstation.intents.session import RenewLease, ReportKeyReleases, SetKeyGate
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import Arm, Disarm, SelectNextVehicle, SelectVehicle, SetMode
from groundstation.snapshot import Snapshot, VehicleView
from groundstation.station.process.crash_neutral import CrashNeutral
from groundstation.station.station import Station
from link.protocol.channel import Channel
from tests.fakes.vehicle import QUERIES, FakeVehicle
from tests.world import Host

FORWARD = DriveKeyDown(key="i", throttle=1, steering=0)
STEP = 0.005


class Convoy:
    """One station, two vehicles. `radio`: both are behind one address, as a radio or a bridge shows them."""

    def __init__(self, *, radio: bool) -> None:
        self.now = 100.0
        self.station = Station(["udpin:127.0.0.1:14550"], now=self.now)
        self._near = Host(CrashNeutral(self.station), Channel("near", 0, system=255, component=190), 0.02)
        self.vehicles = {system: FakeVehicle(system=system) for system in (1, 2)}
        self._far: dict[str, list[Host]] = {}
        """Address -> who is behind it."""
        for system, vehicle in self.vehicles.items():
            channel = Channel("far", 0, system=system, component=1, target="station")
            address = "radio" if radio else f"vehicle {system}"
            self._far.setdefault(address, []).append(Host(vehicle, channel, 0.02))
        self._lease_due = 0.0
        self.do(RenewLease(), SetKeyGate(open=True))

    def do(self, *intents: AnyIntent) -> None:
        for intent in intents:
            self.station.handle_intent(intent, self.now)

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / STEP)):
            self.now += STEP
            if self.now >= self._lease_due:
                self._lease_due = self.now + 0.1
                self.do(RenewLease())
            self._step()

    def _step(self) -> None:
        self._near.advance(self.now)
        for outgoing in self._near.core.messages_to_send():
            for data, address, sequence in self._near.channel.send(outgoing):
                self.station.handle_sent(outgoing.message, sequence, self.now)
                for host in self._far[str(address)]:
                    host.receive(data, "station", self.now)
        for address, hosts in self._far.items():
            for host in hosts:
                host.advance(self.now)
                for data in host.pop_frames(self.now, "station"):
                    self._near.receive(data, address, self.now)

    @property
    def snapshot(self) -> Snapshot:
        return self.station.snapshot(self.now, self.now)

    @property
    def view(self) -> VehicleView:
        view = self.snapshot.vehicle
        assert view is not None
        return view

    def orders(self, system: int) -> int:
        """Return the number of received commands that are not queries."""
        return sum(each.command not in QUERIES for _, each in self.vehicles[system].all(m.CommandLong))

    def demands(self, system: int, since: float) -> list[tuple[float, int]]:
        return [(at, each.x) for at, each in self.vehicles[system].all(m.ManualControl) if at >= since]


@pytest.fixture(params=[False, True], ids=["two addresses", "one radio"])
def convoy(request: pytest.FixtureRequest) -> Convoy:
    """Both found, the first one armed and driven."""
    convoy = Convoy(radio=request.param)
    convoy.run(2.0)
    assert convoy.station.fleet.system_ids == (1, 2)
    assert convoy.view.system == 1
    convoy.do(Arm(held=1.0))
    convoy.run(1.5)
    convoy.do(ReportKeyReleases(), FORWARD)
    convoy.run(0.5)
    assert convoy.demands(1, 0.0)[-1][1] == 600
    assert convoy.demands(2, 0.0) == []
    return convoy


@pytest.mark.parametrize("select", [SelectVehicle(system=2), SelectNextVehicle()])
def test_the_deselected_vehicle_gets_neutral_and_then_nothing(convoy: Convoy, select: AnyIntent) -> None:
    left = convoy.now
    convoy.do(select)
    convoy.run(3.0)
    assert convoy.view.system == 2
    demands = convoy.demands(1, left)
    assert [x for _, x in demands] == [0] * 5
    assert demands[0][0] - left <= 2 * STEP
    assert convoy.demands(2, left) == [], "the key that was held is not for the other one, which is not even armed"
    assert convoy.snapshot.operator.throttle == 0.0
    assert "Rover 2 selected" in [line.text for line in convoy.snapshot.texts]


def test_commands_and_demands_go_to_the_selected_vehicle_only(convoy: Convoy) -> None:
    convoy.do(DriveKeyUp(key="i"), SelectVehicle(system=2))
    convoy.run(1.0)
    before = convoy.orders(1)
    start = convoy.now
    convoy.do(Arm(held=1.0))
    convoy.run(1.5)
    assert convoy.vehicles[2].armed
    convoy.do(FORWARD)
    convoy.run(1.0)
    assert convoy.demands(2, start)[-1][1] == 600
    assert convoy.snapshot.operator.throttle == pytest.approx(0.6)
    convoy.do(SetMode(mode="HOLD"), Disarm())
    convoy.run(2.0)
    assert not convoy.vehicles[2].armed
    assert convoy.demands(1, start) == []
    assert convoy.orders(1) == before
    assert convoy.vehicles[1].armed, "it stands where it was left; its own failsafe looks after it"


def test_the_estop_goes_to_every_vehicle_we_armed_or_drove(convoy: Convoy) -> None:
    convoy.do(SelectNextVehicle())
    convoy.run(1.0)
    assert convoy.snapshot.also_armed == (1,)
    assert not convoy.vehicles[2].armed
    convoy.do(EmergencyStop())
    convoy.run(1.5)
    assert convoy.vehicles[1].locked
    assert convoy.vehicles[2].locked, "the one on the screen"
    assert not convoy.snapshot.also_armed


def test_foreign_armed_vehicle_is_named_and_stopped_by_press_two(convoy: Convoy) -> None:
    convoy.vehicles[2].armed, convoy.vehicles[2].driver = True, 254
    convoy.run(1.2)
    convoy.do(EmergencyStop())
    convoy.run(2.0)
    assert convoy.vehicles[1].locked
    assert convoy.vehicles[2].armed, "not ours: it is named, not stopped"
    assert convoy.orders(2) == 0
    named = "Rover 2 is armed, too: a second emergency stop stops all vehicles"
    assert named in [line.text for line in convoy.snapshot.texts]
    assert convoy.snapshot.also_armed == (2,)
    convoy.do(EmergencyStop())
    convoy.run(1.5)
    assert convoy.vehicles[2].locked


def test_a_late_second_press_is_a_first_one(convoy: Convoy) -> None:
    convoy.vehicles[2].armed, convoy.vehicles[2].driver = True, 254
    convoy.run(1.2)
    convoy.do(EmergencyStop())
    convoy.run(3.1)
    convoy.do(EmergencyStop())
    convoy.run(1.5)
    assert convoy.vehicles[2].armed


def test_a_vehicle_that_we_armed_and_disarmed_is_no_longer_ours(convoy: Convoy) -> None:
    convoy.do(Disarm())
    convoy.run(1.5)
    before = convoy.orders(1)
    convoy.do(SelectVehicle(system=2), EmergencyStop())
    convoy.run(2.0)
    assert convoy.vehicles[2].locked
    assert convoy.orders(1) == before


def test_the_first_stops_although_the_second_is_driven_meanwhile(convoy: Convoy) -> None:
    convoy.vehicles[2].armed, convoy.vehicles[2].driver = True, 255
    convoy.run(1.2)
    left = convoy.now
    convoy.do(SelectNextVehicle(), DriveKeyUp(key="i"))
    convoy.run(0.05)
    convoy.do(FORWARD)
    convoy.run(0.2)
    convoy.do(DriveKeyUp(key="i"), FORWARD)
    convoy.run(0.5)
    assert [x for _, x in convoy.demands(1, left)] == [0] * 5
    assert convoy.demands(2, left)[-1][1] == 600
    assert convoy.snapshot.operator.throttle == pytest.approx(0.6), "neutral for one is not what the other gets"


def test_next_vehicle_wraps_to_the_first(convoy: Convoy) -> None:
    seen = []
    for _ in range(4):
        convoy.do(SelectNextVehicle())
        seen.append(convoy.view.system)
    assert seen == [2, 1, 2, 1]


def test_the_first_one_can_be_driven_again_with_a_new_press(convoy: Convoy) -> None:
    convoy.do(SelectNextVehicle(), SelectNextVehicle())
    back = convoy.now
    convoy.run(0.5)
    assert all(x == 0 for _, x in convoy.demands(1, back))
    convoy.do(DriveKeyUp(key="i"), FORWARD)
    convoy.run(0.5)
    assert convoy.demands(1, back)[-1][1] == 600


def test_selecting_an_unknown_vehicle_keeps_the_selection(convoy: Convoy) -> None:
    convoy.do(SelectVehicle(system=9))
    convoy.run(0.1)
    assert convoy.view.system == 1
    assert "no vehicle with system id 9" in [line.text for line in convoy.snapshot.texts]


def test_alone_there_is_no_next_one() -> None:
    station = Station(["memory"])
    station.handle_intent(SelectNextVehicle(), 1.0)
    assert [line.text for line in station.snapshot(1.0, 1.0).texts] == ["no other vehicle"]


def test_answers_of_one_vehicle_are_not_those_of_the_other(convoy: Convoy) -> None:
    convoy.vehicles[2].silent_on.add(Command.COMPONENT_ARM_DISARM)
    convoy.do(Disarm(), SelectNextVehicle(), Arm(held=1.0))
    convoy.run(4.0)
    assert not convoy.vehicles[1].armed
    assert convoy.view.refusal == "arm: no answer"
    convoy.do(SelectNextVehicle())
    assert convoy.view.refusal is None


@pytest.mark.parametrize("name", ["standard", "teleop"])
def test_a_key_selects_the_next_one_and_stops_what_is_driven(name: str) -> None:
    keymap = Keymap(name, KEYMAPS[name])
    assert keymap.get_keys("vehicle.next") == ("n",)
    assert keymap.build_intents([KeyEvent("n")], armed=True, driving=True) == [Stop(), SelectNextVehicle()]
    assert keymap.build_intents([KeyEvent("n", repeat=True)], armed=False, driving=False) == []
