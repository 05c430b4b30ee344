"""Missions in virtual time: the edit model of the screen, the station and a simulated rover that drives."""

from __future__ import annotations

import math

import pytest

from dialects import messages as m
from dialects.enums import Command
from dialects.modes import Mode
from groundstation.geo import Place
from groundstation.intents.driving import Stop
from groundstation.intents.plan import ChooseMode, GoTo, JumpToItem, SetHome
from groundstation.intents.union import AnyIntent
from groundstation.intents.watch import Watch
from groundstation.station.verbs.running_verbs import VerbMessage
from groundstation.ui.display.request_numbers import RequestNumbers
from groundstation.ui.map.model import MapModel
from groundstation.ui.map.plan.fields import change_command
from groundstation.views.base import View
from groundstation.views.plan import PlanKind, PlanSummary, PlanView
from tests.fakes.verb_seat import verb_of
from tests.test_stops import Drive


class MapDrive(Drive):
    """A Drive whose screen is the Map: its model gets the views and sends the intents."""

    def __init__(self, *, loss: float = 0.0) -> None:
        super().__init__(loss=loss)
        self.numbers = RequestNumbers()
        self.model = MapModel(self.numbers)
        self._watched: object = None
        self.until(lambda: self.view is not None and self.view.place is not None, within=20.0)
        self.until(lambda: all(self.plan(kind).version for kind in PlanKind), within=60.0)

    @property
    def view(self) -> PlanView | None:
        return self.model.view

    def plan(self, kind: PlanKind) -> PlanSummary:
        assert self.view is not None
        return self.view.plans[kind]

    def _each(self, now: float) -> None:
        super()._each(now)
        if self._watched != self.model.requests:
            self._watched = self.model.requests
            self.station.handle_intent(Watch(self.model.requests), now)
        self.station.views.send_due(self._take, now, now)

    def _take(self, view: View) -> bool:
        for intent in self.model.show_view(view):
            self.station.handle_intent(intent, self.world.now)
        return True

    def go(self, *intents: AnyIntent, within: float = 30.0) -> None:
        """Send intents of the model, and let their requests end."""
        self.tell(*intents)
        self.run(0.5)
        self.until(lambda: self.view is not None and not self.view.running, within=within)

    def draw(self, *points: tuple[float, float]) -> None:
        """Add a waypoint at each point, m north and east of home."""
        frame = self.model.ground.frame
        assert frame is not None
        for point in points:
            self.model.ground.cursor = frame.to_place(point)
            assert self.model.add() is None

    def arm(self) -> None:
        """Arm in MANUAL, standing."""
        self.get_going()
        self.held = None
        self.until(lambda: self.power == 0.0)

    def is_in(self, mode: Mode) -> bool:
        """Whether that is the rover's mode."""
        return self.rover._safety.mode is mode

    @property
    def last(self) -> str:
        """How the last request ended."""
        assert self.view is not None
        line = self.view.ended[-1]
        return f"{line.what}: {line.state}" + (f", {line.detail}" if line.detail else "")


def test_a_mission_is_drawn_uploaded_driven_and_changed() -> None:
    drive = MapDrive()
    drive.draw((3.0, 0.0), (3.0, 2.0))
    assert drive.model.upload_fault is None
    drive.go(*drive.model.upload())
    assert drive.last == "upload mission of 2 items: accepted"
    assert drive.model.editor.edited == ()
    assert len(drive.rover._navigator.mission.items) == 2
    drive.arm()
    assert drive.view is not None
    drive.tell(drive.model.intents.start(drive.view))
    drive.until(lambda: drive.power > 0.2)
    assert drive.is_in(Mode.AUTO)
    drive.until(lambda: drive.view is not None and 0 in drive.view.reached, within=60.0)

    drive.tell(Stop())
    drive.until(lambda: drive.power == 0.0, within=3.0)
    assert drive.is_in(Mode.HOLD)
    drive.model.editor.select(1)
    drive.draw((1.0, 2.0))
    drive.go(*drive.model.upload())
    assert drive.last == "upload mission of 3 items: accepted"
    drive.go(drive.model.intents.jump(drive.view, 1))
    drive.tell(drive.model.intents.start(drive.view))
    drive.until(lambda: drive.power > 0.2)
    drive.until(lambda: drive.view is not None and drive.view.state == 5, within=90.0)
    drive.until(lambda: drive.power == 0.0)
    frame = drive.model.ground.frame
    assert frame is not None
    assert drive.view.place is not None
    assert math.dist(frame.to_point(drive.view.place), (1.0, 2.0)) < 1.0


def test_a_new_mission_is_refused_while_auto_drives_the_old_one() -> None:
    drive = MapDrive()
    drive.draw((8.0, 0.0))
    drive.go(*drive.model.upload())
    drive.arm()
    assert drive.view is not None
    drive.tell(drive.model.intents.start(drive.view))
    drive.until(lambda: drive.power > 0.2)
    drive.draw((8.0, 2.0))
    drive.go(*drive.model.upload())
    assert drive.last.startswith("upload mission of 2 items: refused, DENIED")
    assert "AUTO drives by it" in drive.last
    assert drive.model.editor.diff(PlanKind.MISSION).text == "1 new", "the edit is kept"
    assert len(drive.rover._navigator.mission.items) == 1, "so is the old mission"


def test_pausing_stops_the_wheels_and_going_on_turns_them() -> None:
    drive = MapDrive()
    drive.draw((8.0, 0.0))
    drive.go(*drive.model.upload())
    drive.arm()
    assert drive.view is not None
    drive.tell(drive.model.intents.start(drive.view))
    drive.until(lambda: drive.power > 0.2)
    drive.tell(drive.model.intents.pause(drive.view))
    drive.until(lambda: drive.power == 0.0, within=3.0)
    assert drive.is_in(Mode.AUTO)
    drive.until(lambda: drive.view is not None and drive.view.state == 4)
    drive.tell(drive.model.intents.start(drive.view))
    drive.until(lambda: drive.power > 0.2)


def test_going_to_a_place_and_moving_home() -> None:
    drive = MapDrive()
    drive.arm()
    frame, view = drive.model.ground.frame, drive.view
    assert frame is not None
    assert view is not None
    drive.go(drive.model.intents.go_to(view, frame.to_place((0.0, 4.0))))
    assert drive.last.endswith(": accepted")
    drive.until(lambda: drive.power > 0.2)
    assert drive.is_in(Mode.GUIDED)
    drive.go(drive.model.intents.set_home(view, frame.to_place((10.0, 10.0))))
    drive.until(lambda: drive.view is not None and drive.view.home != view.home)
    after = drive.view
    assert after is not None
    assert after.home is not None
    assert math.dist(frame.to_point(after.home), (10.0, 10.0)) < 0.1


@pytest.mark.parametrize("place", [Place(95.0, 0.0), Place(0.0, -190.0), Place(math.nan, 1.0),
                                   Place(0.0, 0.0)])  # fmt: skip
def test_a_place_that_is_not_on_earth_is_refused_here(place: Place) -> None:
    drive = MapDrive()
    drive.go(GoTo(drive.numbers.take(), 1, place))
    assert "refused" in drive.last
    drive.go(SetHome(drive.numbers.take(), 1, place))
    assert "refused" in drive.last
    assert not any("CommandInt" in type(message).__name__ for _, message in drive.world.near.sent)


def test_refusals_have_the_vehicles_own_words() -> None:
    drive = MapDrive()
    assert drive.view is not None
    drive.go(drive.model.intents.start(drive.view))
    assert drive.last.startswith("start the mission: refused, FAILED")
    assert "there is no mission" in drive.last
    drive.run(3.0)  # its words are those of the refusal before, for a second
    drive.go(JumpToItem(drive.numbers.take(), 1, 7))
    assert drive.last == "jump to item 7: refused, DENIED"
    drive.go(ChooseMode(drive.numbers.take(), 1, "FLYING"))
    assert drive.last.startswith("mode FLYING: refused, no such mode")


def test_fence_and_rally_points_go_up_and_come_down() -> None:
    drive = MapDrive()
    drive.model.editor.layer = PlanKind.FENCE
    drive.draw((20, -20), (20, 20), (-20, 20), (-20, -20), (5, 5))
    item = drive.model.editor.row
    assert item is not None
    drive.model.editor.change(change_command(item.item, 5004))
    drive.go(*drive.model.upload())
    drive.model.editor.layer = PlanKind.RALLY
    drive.draw((4, 4))
    drive.go(*drive.model.upload())
    assert drive.model.editor.edited == ()
    fence = drive.model.copies.items[PlanKind.FENCE]
    assert [each.command for each in fence] == [5001] * 4 + [5004]
    assert drive.view is not None
    drive.go(drive.model.intents.clear(drive.view, PlanKind.FENCE))
    drive.until(lambda: drive.model.copies.items[PlanKind.FENCE] == ())
    assert drive.model.editor.rows(PlanKind.FENCE) == ()
    assert len(drive.model.editor.rows(PlanKind.RALLY)) == 1


def test_a_long_mission_comes_in_pages_over_a_link_that_loses() -> None:
    drive = MapDrive(loss=0.15)
    drive.draw(*((float(number % 20), float(number // 20)) for number in range(230)))
    drive.go(*drive.model.upload(), within=200.0)
    assert drive.last == "upload mission of 230 items: accepted"
    drive.tell(Watch())
    drive._watched = ()
    drive.model = again = MapModel(RequestNumbers())
    drive.until(lambda: len(again.editor.rows(PlanKind.MISSION)) == 230, within=30.0)


def test_a_mission_that_another_station_changes_is_named() -> None:
    drive = MapDrive()
    drive.draw((3.0, 0.0))
    drive.go(*drive.model.upload())
    drive.rover._dispatcher._mission.clear()
    drive.until(lambda: "has changed" in drive.model.status)
    assert drive.model.status == "the mission on the vehicle has changed · D downloads it"
    drive.go(*drive.model.download())
    drive.until(lambda: drive.model.editor.rows(PlanKind.MISSION) == ())


def test_the_track_is_thin_and_where_the_vehicle_was() -> None:
    drive = MapDrive()
    drive.arm()
    drive.held = "i"
    drive.run(8.0)
    track = drive.model.copies.track
    assert track is not None
    assert 5 < len(track.points) < 500
    assert math.dist(track.points[0], track.points[-1]) > 1.0


def test_verb_that_only_looks_does_not_end_auto_without_station() -> None:
    drive = MapDrive()
    drive.draw((40.0, 0.0))
    drive.go(*drive.model.upload())
    drive.params.set("FS_GCS_ENABLE", 2)
    drive.arm()
    assert drive.view is not None
    drive.tell(drive.model.intents.start(drive.view))
    drive.until(lambda: drive.power > 0.2)
    drive.screen_lives = False
    drive.run(drive.params["FS_GCS_TIMEOUT"] + 3.0)
    assert (drive.is_in(Mode.AUTO), drive.power > 0.2) == (True, True), "it goes on without a ground station"

    verbs, ended = drive.station.verbs, drive.world.now + 4.0
    verb = verb_of("mavhelm status")
    verbs.join(verb, drive.world.now)
    while drive.world.now < ended:
        for kind in (m.SysStatus, m.VfrHud, m.AutopilotVersion, m.ControlStatus):
            for command in (Command.REQUEST_MESSAGE, Command.SET_MESSAGE_INTERVAL, Command.GET_MESSAGE_INTERVAL):
                params = (float(kind.id), 1e6) if command == Command.SET_MESSAGE_INTERVAL else (float(kind.id), 0.0)
                asked = m.CommandLong(1, 1, command, 0, *params, 0, 0, 0, 0, 0)
                verbs.handle(verb, VerbMessage(asked), drive.world.now)
            drive.run(0.1)
    assert (drive.is_in(Mode.AUTO), drive.power > 0.2) == (True, True)
