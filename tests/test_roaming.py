"""A ground station that drives, and whose address changes: another network, another NAT port."""

from __future__ import annotations

import pytest

from dialects.messages import Heartbeat
from tests.test_stops import Drive


def obeyed_after_a_change_of_address(loss: float, seed: int) -> float:
    """Return the s until the rover obeys a demand from the new address; the key stays pressed."""
    drive = Drive(loss=loss, delay=0.01, seed=seed)
    drive.get_going()
    drive.world.near_address = "another port"
    changed = drive.world.now
    drive.until(lambda: drive.rover._control.demand is not None and drive.rover._control.demand.time > changed, 5.0)
    took = drive.world.now - changed
    drive.held = None
    drive.run(0.5)
    drive.held = "i"
    drive.until(lambda: drive.power > 0.5, 3.0)
    return took


@pytest.mark.parametrize(("loss", "seeds", "bound"), [(0.0, 1, 0.4), (0.1, 4, 0.8), (0.2, 8, 1.0)])
def test_the_driver_is_obeyed_from_a_new_address_within_a_second(loss: float, seeds: int, bound: float) -> None:
    assert max(obeyed_after_a_change_of_address(loss, seed) for seed in range(seeds)) <= bound


def test_heartbeats_go_out_four_times_a_second_while_driving() -> None:
    drive = Drive()
    drive.get_going()
    before = len([message for _, message in drive.world.near.sent if isinstance(message, Heartbeat)])
    drive.run(5.0)
    beats = [message for _, message in drive.world.near.sent if isinstance(message, Heartbeat)]
    assert 19 <= len(beats) - before <= 21
