"""The order of the suite: no test is lost, those that wait are spread, and those that compute keep their order."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest

from tests import order
from tests.rows import each_row


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


def test_each_test_is_of_one_kind(request: pytest.FixtureRequest) -> None:
    items = request.session.items
    waiting, others = order.of_kind(items, order.WAITING)
    assert order.of_kind(items, order.COMPUTING) == (others, waiting)
    assert sorted(map(id, [*waiting, *others])) == sorted(map(id, items))
    assert all(map(order.waits, waiting))
    assert not order.left_out(items)


@each_row(
    ("path", "waiting", "computing"),
    [
        ("e2e/test_start.py", False, True), ("interop/test_mavsdk_vehicle.py", False, True),
        ("groundstation/verbs/control/test_arm.py", False, True), ("vehicle/drive/test_gate.py", True, False),
        ("docs_blocks/test_docs_blocks.py", False, False), ("test_order.py", False, False),
    ],
)  # fmt: skip
def test_files_without_a_test_of_the_kind_are_not_imported(path: str, waiting: bool, computing: bool) -> None:
    file = Path(__file__).parent / path
    assert (order.has_none(file, order.WAITING), order.has_none(file, order.COMPUTING)) == (waiting, computing)


@each_row("group", order.GROUPS)
def test_a_group_is_there(group: str) -> None:
    marker = f'xdist_group("{group}")'
    assert any(marker in path.read_text() for path in Path(__file__).parent.rglob("test_*.py"))


@pytest.mark.xdist_group("order")  # makes it one that waits
def test_a_test_of_a_group_waits(request: pytest.FixtureRequest) -> None:
    assert order.waits(request.node)
    assert not order.gives_way(request.node)


def test_a_test_that_computes_gives_way(request: pytest.FixtureRequest) -> None:
    assert order.gives_way(request.node)
