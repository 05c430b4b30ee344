"""Which publisher drives, and for how long."""

from dialects.axes import NEUTRAL, Axes
from groundstation.ros.sources import MAX_SOURCES, TWIST_SILENCE, DemandSources

GO, TURN = Axes(0.5, 0.0), Axes(0.0, 0.5)


def test_a_demand_stands_for_the_silence_and_not_longer() -> None:
    sources = DemandSources()
    assert sources.push("a", GO, TWIST_SILENCE, 10.0)
    assert sources.axes(10.499) == GO
    assert sources.axes(10.5) == NEUTRAL
    assert sources.axes(10.4) == NEUTRAL, "what has ended does not come back"


def test_each_message_of_the_driver_extends_and_replaces() -> None:
    sources = DemandSources()
    sources.push("a", GO, 0.5, 0.0)
    assert sources.push("a", TURN, 0.5, 0.4)
    assert sources.axes(0.8) == TURN


def test_a_second_publisher_is_ignored_while_the_first_drives() -> None:
    sources = DemandSources()
    sources.push("a", GO, 0.5, 0.0)
    assert not sources.push("b", TURN, 0.5, 0.1)
    assert sources.axes(0.2) == GO


def test_an_ignored_publisher_does_not_drive_on_after_the_first() -> None:
    sources = DemandSources()
    sources.push("a", GO, 0.5, 0.0)
    sources.push("b", TURN, 0.5, 0.1)
    sources.push("a", NEUTRAL, 0.5, 0.2)
    assert sources.axes(0.2) == NEUTRAL
    assert not sources.push("b", TURN, 0.5, 0.3), "it must show neutral first"
    sources.push("b", NEUTRAL, 0.5, 0.4)
    assert sources.push("b", TURN, 0.5, 0.5)
    assert sources.axes(0.5) == TURN


def test_an_idle_publisher_that_repeats_stop_does_not_disturb() -> None:
    sources = DemandSources()
    sources.push("idle", NEUTRAL, 0.8, 0.0)
    sources.push("a", GO, 0.5, 0.1)
    sources.push("idle", NEUTRAL, 0.8, 0.3)
    assert sources.axes(0.3) == GO


def test_anothers_new_stop_holds_until_the_driver_shows_neutral() -> None:
    sources = DemandSources()
    sources.push("a", GO, 0.5, 0.0)
    sources.push("b", NEUTRAL, 0.5, 0.1)
    assert sources.axes(0.1) == NEUTRAL
    assert not sources.push("a", GO, 0.5, 0.2)
    assert sources.axes(0.2) == NEUTRAL
    sources.push("a", NEUTRAL, 0.5, 0.3)
    assert sources.push("a", GO, 0.5, 0.4)


def test_a_publisher_that_leaves_ends_its_demand() -> None:
    sources = DemandSources()
    sources.push("a", GO, 0.5, 0.0)
    assert not sources.remove("b")
    assert sources.axes(0.1) == GO
    assert sources.remove("a")
    assert sources.axes(0.1) == NEUTRAL


def test_a_flood_of_publishers_takes_no_memory_and_moves_nothing() -> None:
    sources = DemandSources()
    for number in range(MAX_SOURCES):
        sources.push(number, NEUTRAL, 10.0, 0.0)
    assert not sources.push("one more", GO, 0.5, 0.1)
    assert sources.axes(0.1) == NEUTRAL
    assert sources.push(0, GO, 0.5, 0.2)
