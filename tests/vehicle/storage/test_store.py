"""NullStore saves nothing, and the stores on it end with the program."""

from __future__ import annotations

from dialects.enums import MissionType
from vehicle.storage.param_store import ParamStore
from vehicle.storage.plan_store import PlanStore
from vehicle.storage.store import NullStore


def test_a_write_to_nowhere_is_complete_at_once() -> None:
    store = NullStore()
    pending = store.write("parameters", lambda: b"x")
    assert (pending.done, pending.problem) == (True, None)
    assert store.read("parameters", bytes) is None
    assert (store.idle, store.problem) == (True, None)
    store.close()


def test_stores_without_a_folder_are_volatile_and_work() -> None:
    params, plans = ParamStore(), PlanStore()
    params.set("SPEED_MAX", 2.0)
    assert plans.save(MissionType.MISSION, ()).done
    assert (params.values, params.damage, params.problem, params.idle) == ({"SPEED_MAX": 2.0}, None, None, True)
    assert (plans.damage, plans.problem, plans.idle) == ({}, None, True)
    assert (params.is_volatile, plans.is_volatile) == (True, True)
