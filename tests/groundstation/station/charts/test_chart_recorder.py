"""What the station records for charts: fields by their names and units, ready views, marks of a drive."""

from __future__ import annotations

from array import array

from dialects import messages as m
from groundstation.intents.driving import DriveKeyDown
from groundstation.intents.session import SetKeyGate
from groundstation.intents.vehicle import Arm, SetMode
from groundstation.intents.vehicle_intent import HOLD_TIME
from groundstation.intents.watch import Watch
from groundstation.views.base import View
from groundstation.views.charts import STATION, FieldId, FieldsPage, FieldsRequest, SeriesPage, SeriesRequest
from tests.groundstation.cockpits import Cockpit

VOLTS = FieldId(1, 1, False, "SYS_STATUS", "voltage_battery")
TYPE = FieldId(1, 1, False, "HEARTBEAT", "type")
BEAT_SENT = FieldId(255, 190, True, "HEARTBEAT", "type")
ROUND_TRIP = FieldId(0, 0, False, STATION, "round_trip")


class Desk:
    """A cockpit with the views that its screen gets."""

    def __init__(self) -> None:
        self.cockpit = Cockpit()
        self.views: list[View] = []
        self.fields_drawn: tuple[FieldId, ...] = ()
        self.cockpit.run(3.0)

    def draw(self, *fields: FieldId) -> None:
        """Request these fields, as a screen does: each page is followed by a request for what comes after it."""
        state = max((view.state for view in self.views if isinstance(view, SeriesPage)), default=0)
        self.fields_drawn = fields
        self.cockpit.do(Watch((SeriesRequest(fields, state),)))

    def send(self, view: View) -> bool:
        self.views.append(view)
        if isinstance(view, SeriesPage):
            self.draw(*self.fields_drawn)
        return True

    def run(self, seconds: float, volts: int | None = None) -> None:
        """Run, with a SYS_STATUS ten times a second where `volts` is given, mV."""
        for step in range(round(seconds / 0.025)):
            if volts is not None and step % 4 == 0:
                self.cockpit.vehicle.send(m.SysStatus(0, 0, 0, 0, volts, 100, 50, 0, 0, 0, 0, 0, 0))
            self.cockpit.run(0.025)
            self.cockpit.station.views.send_due(self.send, self.cockpit.now, 1e9)

    def newest(self, kind: type[View]) -> View:
        return [view for view in self.views if isinstance(view, kind)][-1]

    @property
    def fields(self) -> FieldsPage:
        page = self.newest(FieldsPage)
        assert isinstance(page, FieldsPage)
        return page

    def values(self, field: FieldId) -> list[float]:
        found: list[float] = []
        for page in self.views:
            if isinstance(page, SeriesPage):
                found += [value for each in page.points if each.field == field for value in array("d", each.values)]
        return found

    @property
    def marks(self) -> list[tuple[str, str]]:
        pages = (view for view in self.views if isinstance(view, SeriesPage))
        return [(mark.kind, mark.text) for page in pages for mark in page.marks]


def test_a_drawn_field_comes_in_the_unit_that_people_use() -> None:
    desk = Desk()
    desk.draw(VOLTS, TYPE, BEAT_SENT)
    desk.run(2.0, volts=12104)
    assert {round(value, 6) for value in desk.values(VOLTS)} == {12.104}
    assert set(desk.values(TYPE)) == {10.0}
    assert set(desk.values(BEAT_SENT)) == {6.0}


def test_an_unknown_value_is_no_point() -> None:
    desk = Desk()
    desk.draw(VOLTS)
    desk.run(2.0, volts=0xFFFF)
    assert desk.values(VOLTS) == []


def test_what_was_drawn_is_recorded_while_the_screen_is_closed() -> None:
    """Keys drive on Drive only: the charts of a drive are looked at after it."""
    desk = Desk()
    desk.draw(VOLTS)
    desk.run(1.0)
    desk.cockpit.do(Watch(()))
    desk.run(5.0, volts=11000)
    before = len(desk.views)
    desk.draw(VOLTS)
    desk.run(1.0)
    assert len(desk.views) > before
    assert len([value for value in desk.values(VOLTS) if value == 11.0]) >= 20


def test_what_is_neither_drawn_nor_pinned_is_not_recorded() -> None:
    desk = Desk()
    desk.draw(VOLTS)
    desk.run(1.0)
    desk.draw(TYPE)
    desk.run(5.0, volts=11000)
    desk.draw(TYPE, VOLTS)
    desk.run(1.0)
    assert len(desk.values(VOLTS)) <= 8


def test_the_station_measures_the_link() -> None:
    desk = Desk()
    desk.draw(ROUND_TRIP)
    desk.run(3.0)
    assert len(desk.values(ROUND_TRIP)) >= 5
    assert all(0 <= value < 1000 for value in desk.values(ROUND_TRIP))


def test_fields_are_found_by_fuzzy_names_with_their_values() -> None:
    desk = Desk()
    desk.cockpit.do(Watch((FieldsRequest("sysvolt", 10, (VOLTS, TYPE, FieldId(1, 1, False, "NO_SUCH", "x"))),)))
    desk.run(1.0, volts=12104)
    page = desk.fields
    assert [(row.field, row.value) for row in page.rows] == [(VOLTS, "12.104 V")]
    volts, kind, missing = page.known
    assert (volts.unit, volts.decimals, volts.heard) == ("V", 3, True)
    assert (10, "GROUND_ROVER") in kind.names
    assert missing.heard is False


def test_ready_views_are_built_from_what_the_vehicle_sends() -> None:
    desk = Desk()
    desk.cockpit.do(Watch((FieldsRequest(),)))
    desk.run(1.0)
    drive, power, link, obstacles = desk.fields.ready
    assert (drive.name, drive.charts, power.name, power.charts) == ("drive", (), "power", ())
    assert link.charts[0].fields[0] == ROUND_TRIP
    assert (obstacles.name, obstacles.charts) == ("obstacles", ())
    desk.run(1.0, volts=12104)
    power = desk.fields.ready[1]
    assert [chart.title for chart in power.charts] == ["voltage", "current", "charge"]
    assert power.charts[0].fields == (VOLTS,)


def test_modes_arming_and_own_keys_are_marked_once() -> None:
    desk = Desk()
    desk.draw(VOLTS)
    desk.cockpit.do(Arm(held=HOLD_TIME))
    desk.run(1.0)
    for _ in range(10):
        desk.cockpit.do(DriveKeyDown("i", 1, 0))
        desk.run(0.1)
    desk.cockpit.do(SetMode("HOLD"))
    desk.run(1.0)
    assert desk.marks == [("mode", "MANUAL"), ("armed", "armed"), ("key", "i"), ("mode", "HOLD")]


def test_keys_behind_a_closed_gate_are_no_marks() -> None:
    desk = Desk()
    desk.cockpit.do(SetKeyGate(open=False, reason="other screen"))
    desk.draw()
    desk.cockpit.do(DriveKeyDown("i", 1, 0))
    desk.run(0.5)
    assert desk.marks == [("mode", "MANUAL")]


def test_a_lost_link_is_marked_when_it_ends_and_comes_back() -> None:
    desk = Desk()
    desk.draw()
    beat = desk.cockpit.vehicle.beat
    desk.cockpit.vehicle.beat = lambda: None  # type: ignore[method-assign]
    desk.cockpit.vehicle.silent_on = set(range(1000))
    desk.cockpit.vehicle.receive = lambda received, now: None  # type: ignore[method-assign]
    desk.run(5.0)
    desk.cockpit.vehicle.beat = beat  # type: ignore[method-assign]
    desk.run(2.0)
    assert desk.marks == [("mode", "MANUAL"), ("link", "link lost"), ("link", "link back")]


def test_the_first_drive_is_there_before_any_chart_was_drawn() -> None:
    """The view that opens by itself shows what was driven before the screen was opened for the first time."""
    desk = Desk()
    speed = FieldId(1, 1, False, "VFR_HUD", "groundspeed")
    for _ in range(20):
        desk.cockpit.vehicle.send(m.VfrHud(0, 1.25, 0, 0, 0, 0))
        desk.run(0.25)
    desk.draw()
    desk.run(0.5)
    desk.draw(speed)
    desk.run(1.0)
    assert len([value for value in desk.values(speed) if value == 1.25]) >= 15
