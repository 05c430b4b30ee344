"""The order of the suite: no test is lost, those that wait are spread, and those that compute keep their order."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest

from tests import order


def test_all_are_there_once_and_computing_ones_keep_their_order(request: pytest.FixtureRequest) -> None:
    items = list(request.session.items)
    place = {id(item): number for number, item in enumerate(items)}
    mixed = order.mix(items)
    assert sorted(map(id, mixed)) == sorted(map(id, items))
    computing = [item for item in mixed if not order.waits(item)]
    assert len(computing) == len([item for item in items if not order.waits(item)])
    for long in (True, False):
        places = [place[id(item)] for item in computing if order.computes_long(item) == long]
        assert places == sorted(places)


def test_tests_that_compute_for_long_come_first(request: pytest.FixtureRequest) -> None:
    computing = [item for item in order.mix(request.session.items) if not order.waits(item)]
    long = [order.computes_long(item) for item in computing]
    assert long == sorted(long, reverse=True)


@pytest.mark.parametrize("name", order.LONG)
def test_what_computes_for_long_is_there(name: str) -> None:
    assert (Path(__file__).parents[1] / name).exists()


@pytest.mark.parametrize(("few", "many"), [(0, 5), (3, 0), (1, 10), (10, 100), (100, 10), (700, 9700)])
def test_what_waits_is_spread_and_has_begun_before_the_end(few: int, many: int) -> None:
    mixed = list(order.spread([-1] * few, list(range(many))))
    assert [each for each in mixed if each >= 0] == list(range(many))
    assert mixed.count(-1) == few
    places = [place for place, each in enumerate(mixed) if each < 0]
    if few and many > few:
        gaps = [after - before for before, after in pairwise(places)]
        assert not gaps or max(gaps) - min(gaps) <= 1
        assert len(mixed) - places[-1] > many * (1 - order.LAST)


def test_a_test_that_computes_gives_way(request: pytest.FixtureRequest) -> None:
    assert order.gives_way(request.node)
