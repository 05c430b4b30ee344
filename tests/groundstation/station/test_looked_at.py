"""Which vehicles a station looks at: what is selected, driven, asked for something or drawn, and all for a verb."""

from __future__ import annotations

from groundstation.intents.services import FetchParams
from groundstation.intents.vehicle import SelectVehicle
from groundstation.intents.watch import Watch
from groundstation.views.charts import FieldId, SeriesRequest
from groundstation.views.messages import MessageRequest
from tests.fakes.verb_seat import verb_of
from tests.groundstation.flotilla import Flotilla


def test_the_selected_vehicle_and_what_is_asked_for_something() -> None:
    flotilla = Flotilla(4)
    station = flotilla.station
    assert station.interesting_systems == frozenset()
    flotilla.run(3.0)
    assert station.interesting_systems == frozenset((1,))
    station.handle_intent(SelectVehicle(system=2), flotilla.now)
    assert station.interesting_systems == frozenset((2,))
    station.handle_intent(FetchParams(request=1, system=3), flotilla.now)
    assert station.interesting_systems == frozenset((2, 3))


def test_a_driven_vehicle_is_of_interest_whatever_is_selected() -> None:
    flotilla = Flotilla(3)
    flotilla.run(3.0)
    driven = flotilla.station.fleet.get(1)
    assert driven is not None
    flotilla.station.handle_intent(SelectVehicle(system=2), flotilla.now)
    assert flotilla.station.interesting_systems == frozenset((2,))
    driven.ours = driven.state.armed = True
    assert flotilla.station.interesting_systems == frozenset((1, 2))


def test_what_a_screen_shows_or_draws_of_another_vehicle() -> None:
    flotilla = Flotilla(3)
    flotilla.run(3.0)
    series = SeriesRequest(fields=(FieldId(3, 1, False, "ATTITUDE", "roll"), FieldId(2, 1, True, "HEARTBEAT", "type")))
    flotilla.station.handle_intent(Watch((MessageRequest(2, 1, False, "SYS_STATUS"), series)), flotilla.now)
    flotilla.run(0.5)
    assert flotilla.station.interesting_systems == frozenset((1, 2, 3))
    other = flotilla.station.views.open_another()
    flotilla.station.handle_intent(Watch(()), flotilla.now)
    other.watch((MessageRequest(2, 1, False, "SYS_STATUS"),))
    flotilla.run(5.0)
    assert flotilla.station.interesting_systems == frozenset((1, 2, 3)), "what was drawn last is recorded on"
    flotilla.station.handle_intent(Watch((SeriesRequest(fields=()),)), flotilla.now)
    flotilla.run(0.5)
    assert flotilla.station.interesting_systems == frozenset((1, 2))


def test_a_verb_gets_what_all_vehicles_send() -> None:
    flotilla = Flotilla(3)
    flotilla.run(3.0)
    verb = verb_of("mavhelm watch")
    flotilla.station.verbs.join(verb, flotilla.now)
    assert flotilla.near.core.interesting_systems is None  # type: ignore[attr-defined]
    flotilla.station.verbs.leave(verb, flotilla.now)
    assert flotilla.near.core.interesting_systems == frozenset((1,))  # type: ignore[attr-defined]
    flotilla.near.core.activate(flotilla.now)  # type: ignore[attr-defined]
    assert flotilla.near.core.interesting_systems == frozenset()  # type: ignore[attr-defined]
