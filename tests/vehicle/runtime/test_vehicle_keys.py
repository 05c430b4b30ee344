"""VehicleKeys: a running vehicle takes over keys that are added and revoked beside it."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import pytest

from link.signing.key_actions import make_key, remove_key
from link.signing.key_file import KeyFileError
from link.signing.keys import KeyRing, new_key
from link.signing.role import SigningRole
from vehicle.runtime.vehicle_keys import VehicleKeys

PATIENCE = 10.0


def until(vehicle_keys: VehicleKeys, condition: Callable[[], bool]) -> None:
    deadline, now = time.monotonic() + PATIENCE, 0.0
    while not condition():
        assert time.monotonic() < deadline
        now += 0.5
        vehicle_keys.poll(now)
        time.sleep(0.001)


def test_a_key_made_beside_it_is_adopted_and_a_revoked_one_ends(tmp_path: Path) -> None:
    path = tmp_path / "keys.toml"
    vehicle_keys = VehicleKeys(path)
    heard: list[KeyRing] = []
    vehicle_keys.listeners.append(heard.append)
    key = make_key(path, "laptop", SigningRole.DRIVE)
    until(vehicle_keys, lambda: vehicle_keys.ring.find("laptop") == key)
    remove_key(path, "laptop")
    until(vehicle_keys, lambda: not vehicle_keys.ring.keys)
    assert [len(ring.keys) for ring in heard] == [1, 0]
    vehicle_keys.close()


def test_a_key_is_added_and_a_second_time_refused(tmp_path: Path) -> None:
    vehicle_keys = VehicleKeys(tmp_path / "keys.toml")
    key = new_key("cable", SigningRole.SET_UP)
    first = vehicle_keys.add(key)
    until(vehicle_keys, lambda: first.done)
    assert first.problem is None
    until(vehicle_keys, lambda: vehicle_keys.ring.find("cable") == key)
    second = vehicle_keys.add(key)
    until(vehicle_keys, lambda: second.done)
    assert second.problem == "see the log of the vehicle"
    vehicle_keys.close()


def test_keys_of_a_file_that_is_broken_meanwhile_stay_in_force(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = tmp_path / "keys.toml"
    make_key(path, "laptop", SigningRole.DRIVE)
    vehicle_keys = VehicleKeys(path)
    path.write_text("[[key]\n")
    until(vehicle_keys, lambda: "stay in force" in caplog.text)
    assert vehicle_keys.ring.find("laptop") is not None
    vehicle_keys.close()
    with pytest.raises(KeyFileError):
        VehicleKeys(path)
