"""How the suite orders its tests for several workers."""

from __future__ import annotations

from itertools import pairwise

from tests.conftest import LONG_UNTIL, spread


def test_long_tests_are_spread_and_nothing_is_lost() -> None:
    items = [*range(-10, 0), *range(100)]
    order = spread(items, lambda item: item < 0)
    assert sorted(order) == sorted(items)
    assert [item for item in order if item >= 0] == list(range(100)), "the others keep their order"
    assert [item for item in order if item < 0] == list(range(-10, 0))
    places = [order.index(item) for item in range(-10, 0)]
    assert max(later - earlier for earlier, later in pairwise(places)) <= 11
    assert max(places) < LONG_UNTIL * len(order) + 1


def test_without_long_tests_or_others() -> None:
    assert spread([1, 2], lambda item: False) == [1, 2]
    assert spread([1, 2], lambda item: True) == [1, 2]
