"""What the station notes for the telemetry log: keys, decisions, the screen, links, requests; each change once."""

from __future__ import annotations

from dialects.enums import Severity
from dialects.enums import StationEventKind as Kind
from dialects.messages import RoverStationEvent, decode_text
from groundstation.input.style import Style
from groundstation.intents.driving import DriveKeyDown, DriveKeyUp, SetStyle, StepLimits, Stop
from groundstation.intents.services import FetchParams
from groundstation.intents.session import ReportScreen, SetKeyGate
from groundstation.intents.vehicle import Disarm, ReleaseControl
from groundstation.station.notes.station_notes import REPEATED_WITHIN
from link.core import LinkReport
from tests.groundstation.cockpits import FORWARD, LEFT, Cockpit, armed_cockpit, driving_cockpit

BACK = DriveKeyDown(key=",", throttle=-1, steering=0)


class Notebook:
    """Takes the notes of a cockpit from now on."""

    def __init__(self, cockpit: Cockpit) -> None:
        self.notes: list[tuple[float, RoverStationEvent]] = []
        cockpit.station.notes.sink = lambda now, note: self.notes.append((now, note))
        cockpit.run(0.1)
        self.notes.clear()

    def of(self, *kinds: Kind) -> list[str]:
        return [decode_text(note) for _, note in self.notes if note.kind in kinds]

    def of_keys(self) -> list[tuple[str, int, int]]:
        return [(decode_text(note), note.throttle, note.steering) for _, note in self.notes if note.kind in KEYS]


KEYS = (Kind.KEYS_DOWN, Kind.KEYS_UP)


def test_each_key_is_noted_once_with_the_demand_that_it_makes() -> None:
    cockpit = driving_cockpit()
    book = Notebook(cockpit)
    for _ in range(5):
        cockpit.do(DriveKeyDown(key="i", throttle=1, steering=0, repeat=True))
    cockpit.do(LEFT)
    cockpit.do(DriveKeyUp("i"))
    cockpit.do(DriveKeyUp("j"))
    assert book.of_keys() == [("j", 600, -600), ("i: released", 0, -600), ("j: released", 0, 0)]
    assert {note.target_system for _, note in book.notes} == {1}


def test_without_key_releases_the_note_tells_when_the_key_ends() -> None:
    cockpit = armed_cockpit()
    book = Notebook(cockpit)
    begun = cockpit.now
    cockpit.do(FORWARD)
    cockpit.run(1.5)
    assert book.of_keys() == [("i", 600, 0), ("i: no repeat", 0, 0)]
    assert 0.4 < book.notes[-1][0] - begun < 0.9


def test_another_key_of_the_stick_a_stop_and_the_gate_end_a_key() -> None:
    cockpit = armed_cockpit()
    book = Notebook(cockpit)
    cockpit.do(FORWARD)
    cockpit.do(BACK)
    cockpit.do(Stop())
    cockpit.run(1.0)
    cockpit.do(FORWARD)
    cockpit.do(SetKeyGate(open=False, reason="another screen is open"))
    assert [text for text, _, _ in book.of_keys()] == [
        *("i", "i: , in its place", ",", ",: stop key"),
        *("i", "i: another screen is open"),
    ]
    assert book.of(Kind.DECISION) == ["keys do not drive: another screen is open"]


def test_a_latched_key_is_noted_until_the_stop() -> None:
    cockpit = armed_cockpit()
    cockpit.do(SetStyle(Style.LATCH))
    book = Notebook(cockpit)
    cockpit.do(FORWARD)
    cockpit.run(2.0)
    for _ in range(3):
        cockpit.do(BACK)
    cockpit.do(Stop())
    assert book.of_keys() == [("i", 600, 0), (",", -600, 0), ("stop key", 0, 0)]


def test_the_override_of_obstacles_is_a_decision() -> None:
    cockpit = driving_cockpit()
    book = Notebook(cockpit)
    cockpit.do(DriveKeyDown(key="b", throttle=0, steering=0, override=True), DriveKeyUp("b"))
    assert book.of(Kind.DECISION) == ["limits before obstacles overridden", "limits before obstacles count again"]


def test_keys_that_are_letters_on_another_screen_are_not_noted() -> None:
    cockpit = armed_cockpit()
    cockpit.do(SetKeyGate(open=False, reason="a text field has the keys"))
    book = Notebook(cockpit)
    for key in ("i", "j", "l"):
        cockpit.do(DriveKeyDown(key=key, throttle=1, steering=0))
        cockpit.run(0.1)
    assert book.notes == []


def test_a_key_that_does_not_count_is_noted_once_with_the_reason() -> None:
    cockpit = driving_cockpit()
    cockpit.do(Disarm())
    book = Notebook(cockpit)
    for _ in range(10):
        cockpit.do(DriveKeyDown(key="i", throttle=1, steering=0, repeat=True))
        cockpit.run(REPEATED_WITHIN / 10)
    assert book.of(Kind.DECISION).count("key i does not count: it was held before") == 1


def test_a_screen_that_freezes_is_a_decision_with_its_reason() -> None:
    cockpit = driving_cockpit()
    book = Notebook(cockpit)
    begun = cockpit.now
    cockpit.leasing = False
    cockpit.run(0.6)
    assert book.of_keys() == [("i: screen not responding", 0, 0)]
    assert book.notes[0][0] - begun < 0.5
    assert "keys do not drive: screen not responding" in book.of(Kind.DECISION)
    lapse = next(note for _, note in book.notes if "display not responding" in decode_text(note))
    assert (lapse.kind, lapse.severity) == (Kind.DECISION, Severity.CRITICAL)


def test_actions_screens_requests_and_control_have_their_kinds() -> None:
    cockpit = armed_cockpit()
    book = Notebook(cockpit)
    cockpit.do(ReportScreen("map"), StepLimits(throttle=-0.1), FetchParams(request=1), ReleaseControl(), Disarm())
    cockpit.run(2.0)
    assert book.of(Kind.SCREEN) == ["map"]
    assert book.of(Kind.ACTION) == ["limits: speed 50 %, turn 60 %", "disarm"]
    assert book.of(Kind.REQUEST)[0] == "fetch parameters"
    assert "release control" in book.of(Kind.CONTROL)
    assert "keys do not drive: releasing control" in book.of(Kind.DECISION)


def test_links_are_noted_when_they_open_fail_and_close() -> None:
    cockpit = armed_cockpit()
    book = Notebook(cockpit)
    notes = cockpit.station.notes
    notes.observe([LinkReport("serial:/dev/ttyUSB0", 7)], 9.0)
    notes.observe([LinkReport("serial:/dev/ttyUSB0", 7)], 10.0)
    cockpit.station.log.add(10.5, "station", "serial:/dev/ttyUSB0: unplugged", Severity.ERROR)
    notes.observe([], 11.0)
    assert book.of(Kind.LINK_OPENED, Kind.LINK_FAULT, Kind.LINK_CLOSED)[-3:] == [
        "serial:/dev/ttyUSB0",
        "serial:/dev/ttyUSB0: unplugged",
        "serial:/dev/ttyUSB0",
    ]


def test_vehicle_texts_are_not_noted_again_and_a_long_one_is_cut() -> None:
    cockpit = armed_cockpit()
    book = Notebook(cockpit)
    cockpit.station.log.add(1.0, "vehicle", "battery low", Severity.WARNING)
    cockpit.station.log.add(1.0, "station", "ü" * 160, Severity.WARNING)
    assert book.of(*Kind) == ["ü" * 50]
