"""A fleet with two linked routers, each program in a network of its own: a cut, a frozen router, a killed one.

`python -m tests.benchmarks --only fleet_outages` measures longer ones, also over QUIC.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack

import pytest

from tests.e2e.fleet_driver import FALL, MAN_TIMEOUT, ROUTERS, VEHICLE, Fleet
from tests.e2e.namespaces import Namespaces, why_not
from tests.waits import Waits

REASON = why_not()
pytestmark = [
    pytest.mark.slow,
    pytest.mark.e2e,
    pytest.mark.xdist_group("fleet networks"),
    pytest.mark.skipif(REASON is not None, reason=str(REASON)),
]

LEASE = 2.0
"""s until a silent session ends (link/fleet/config.py)."""
OBEYED_WITHIN = 1.0
"""s from the end of a cut to a command that is obeyed."""


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Fleet, Namespaces]]:
    with ExitStack() as stack:
        networks = Namespaces([*ROUTERS, VEHICLE], stack)
        yield Fleet(tmp_path_factory.mktemp("networks"), stack, networks), networks


def test_after_a_4_s_cut_nothing_old_moves_and_control_is_back(made: tuple[Fleet, Namespaces]) -> None:
    fleet, networks = made
    waits = Waits(fleet.wires.vehicle.process.pid)
    with ExitStack() as cut:
        found = fleet.suffer(4.0, lambda: cut.enter_context(networks.cut(VEHICLE)), cut.close)
    assert not found.moved
    assert found.stood <= MAN_TIMEOUT + FALL + waits.total()
    assert found.back + found.obeyed <= OBEYED_WITHIN + waits.total()


def test_a_frozen_router_is_left_for_the_other_one(made: tuple[Fleet, Namespaces]) -> None:
    fleet, _ = made
    waits = Waits(fleet.wires.vehicle.process.pid)
    in_use = fleet.router_in_use
    found = fleet.suffer(7.0, in_use.freeze, lambda: None)
    try:
        assert not found.moved
        assert found.stood <= MAN_TIMEOUT + FALL + waits.total()
        assert found.silence <= LEASE + 1.0 + waits.total()
    finally:
        thawed = fleet.wires.now
        in_use.thaw()
    fleet.rest()
    assert not fleet.wires.vehicle.moved_since(thawed), "what it kept moves nothing"


def test_a_killed_router_is_replaced_at_once(made: tuple[Fleet, Namespaces]) -> None:
    fleet, _ = made
    waits = Waits(fleet.wires.vehicle.process.pid)
    in_use = fleet.router_in_use
    found = fleet.suffer(2.0, in_use.kill, lambda: None)
    assert not found.moved
    assert found.silence <= 1.0 + waits.total()
    in_use.start()
