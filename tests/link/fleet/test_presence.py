"""Who is connected: a token that comes back in time was never away."""

from __future__ import annotations

from link.fleet.presence import GRACE, Presence


def test_a_restart_of_the_router_ends_no_conversation() -> None:
    presence = Presence()
    assert presence.add("alice/1")
    presence.remove("alice/1", 10.0)
    assert presence.expire(10.0 + GRACE - 0.1) == []
    assert not presence.add("alice/1")
    assert presence.expire(99.0) == []


def test_who_is_away_for_longer_has_gone() -> None:
    presence = Presence()
    presence.add("alice/1")
    presence.remove("alice/1", 10.0)
    presence.remove("alice/1", 12.0)
    presence.remove("bob/1", 10.0)
    assert presence.expire(10.0 + GRACE) == ["alice/1"]
    assert presence.add("alice/1")


def test_nobody_fills_the_memory_with_tokens() -> None:
    presence = Presence()
    assert [presence.add(f"alice/{number}") for number in range(6000)].count(True) == 32
    assert presence.add("bob/1"), "the tokens of one operator keep no other out"
    for number in range(6000):
        presence.add(f"o{number // 30}/{number}")
    assert len(presence.present) == 256
    assert not presence.add("alice/0")


def test_a_system_id_belongs_to_its_first_present_vehicle() -> None:
    presence = Presence()
    presence.add("rover1")
    assert presence.owner(7, "rover1") == "rover1"
    assert presence.owner(7, "rover2") == "rover1"
    presence.remove("rover1", 0.0)
    presence.expire(GRACE)
    assert presence.owner(7, "rover2") == "rover2"
