"""Tools for a MAVSDK script: plugins by name, values from callbacks, and steps that are printed as JSON."""

from __future__ import annotations

import json
import sys
import threading
import time
from collections.abc import Callable
from enum import Enum
from importlib import import_module
from typing import Any

from tests.waits import PATIENCE

Subscribe = Callable[[Callable[..., None]], Any]
NEUTRALS = 8
"""Neutral messages before the stick moves: more than a lossy link loses in a row."""


def plugin(name: str, system: Any) -> Any:
    """Return the object of a plugin; MAVSDK has a module of the same name for each."""
    module = import_module(f"mavsdk.plugins.{name}.{name}")
    return getattr(module, "".join(part.capitalize() for part in name.split("_")))(system)


def step(name: str, run: Callable[[], Any]) -> Any:
    """Run a step; print its result and its duration."""
    start = time.monotonic()
    try:
        value, error = run(), None
    except Exception as exception:
        value, error = None, f"{type(exception).__name__}: {exception}"
    took = time.monotonic() - start
    # In one write: callbacks run in a thread of MAVSDK.
    sys.stdout.write(json.dumps({"step": name, "value": shown(value), "error": error, "took": took}) + "\n")
    sys.stdout.flush()
    return value


def shown(value: Any) -> Any:
    """Return a value as JSON can hold it."""
    if isinstance(value, Enum):
        return value.name
    return value if isinstance(value, int | float | str | list | None) else str(value)


def first(subscribe: Subscribe, good: Callable[[Any], bool]) -> Any:
    """Return the first value of a stream that is `good`."""
    return following(subscribe, good)()


def following(subscribe: Subscribe, good: Callable[[Any], bool]) -> Callable[[], Any]:
    """Listen for a value of a stream that is `good`, from now on; the returned function waits for it."""
    came, found = threading.Event(), []

    def take(value: Any, *_: Any) -> None:
        if good(value) and not came.is_set():
            found.append(value)
            came.set()

    def wait() -> Any:
        if not came.wait(PATIENCE):
            raise TimeoutError("nothing came")
        return found[0]

    subscribe(take)
    return wait


def twenty(subscribe: Subscribe) -> None:
    """Wait for the next 20 values of a stream."""
    came = threading.Semaphore(0)
    subscribe(lambda *_: came.release())
    for _ in range(20):
        if not came.acquire(timeout=PATIENCE):
            raise TimeoutError("nothing came")


def finished(start: Callable[[Callable[..., None]], Any]) -> str:
    """Return the final result of a transfer that reports its progress."""
    done, results = threading.Event(), []

    def take(result: Any, *_: Any) -> None:
        if result.name != "NEXT":
            results.append(result.name)
            done.set()

    start(take)
    if not done.wait(PATIENCE):
        raise TimeoutError("it did not end")
    return str(results[0])


def fetched(start: Callable[[Callable[..., None]], Any]) -> str:
    """Return the final result of a transfer that must succeed."""
    result = finished(start)
    if result != "SUCCESS":
        raise RuntimeError(result)
    return result


def wait_until(condition: Callable[[], bool]) -> bool:
    """Poll until the condition is true."""
    deadline, pause = time.monotonic() + PATIENCE, threading.Event()
    while not condition() and time.monotonic() < deadline:
        pause.wait(0.1)
    return condition()


def insist(attempt: Callable[[], Any]) -> Any:
    """Retry until it works, as an operator does on a lossy link, where MAVSDK's own retries sometimes all fail.

    MAVSDK's first HEARTBEAT may come later than its first command, which the vehicle then refuses. So arming is retried
    too.
    """
    deadline, pause = time.monotonic() + PATIENCE, threading.Event()
    while True:
        try:
            return attempt()
        except Exception:
            if time.monotonic() > deadline:
                raise
        pause.wait(0.2)


def unless_busy(attempt: Callable[[], Any]) -> Any:
    """Retry while MAVSDK is busy: it reports the end of a transfer a moment before it can start another."""
    deadline, pause = time.monotonic() + PATIENCE, threading.Event()
    while True:
        try:
            return attempt()
        except Exception as error:
            if "BUSY" not in str(error) or time.monotonic() > deadline:
                raise
        pause.wait(0.05)


def refused(attempt: Callable[[], Any], why: str) -> None:
    """Check that the call is refused for this reason."""
    try:
        attempt()
    except Exception as error:
        if why not in str(error):
            raise
    else:
        raise AssertionError("it was not refused")


def by_hand(manual: Any, throttle: float) -> None:
    """Hold the stick, neutral first, until a line comes on stdin."""
    end = threading.Event()

    def listen() -> None:
        sys.stdin.readline()
        end.set()

    threading.Thread(target=listen, daemon=True).start()
    sent = 0
    while not end.wait(0.05):
        manual.set_manual_control_input(0.0 if sent < NEUTRALS else throttle, 0.0, 0.0, 0.0)
        sent += 1


class Stick:
    """A stick that a thread repeats, neutral first."""

    def __init__(self, manual: Any) -> None:
        self._manual = manual
        self._throttle: float | None = None
        self._neutrals = 0
        threading.Thread(target=self._run, daemon=True).start()

    def hold(self, throttle: float) -> None:
        """Hold the stick there from now on."""
        self._throttle, self._neutrals = throttle, NEUTRALS

    def _run(self) -> None:
        pause = threading.Event()
        while not pause.wait(0.05):
            if self._throttle is not None:
                self._manual.set_manual_control_input(0.0 if self._neutrals else self._throttle, 0.0, 0.0, 0.0)
                self._neutrals = max(0, self._neutrals - 1)


def watch(telemetry: Any) -> None:
    """Print what the vehicle does: each text, each change of `armed`, and once its position and its motion."""
    told: dict[str, Any] = {}

    def tell(name: str, value: Any) -> None:
        if told.get(name) != value:
            told[name] = value
            step(name, lambda: value)

    telemetry.subscribe_status_text(lambda text, *_: step("text", lambda: text.text))
    telemetry.subscribe_armed(lambda armed, *_: tell("armed", bool(armed)))
    telemetry.subscribe_attitude_euler(lambda *_: tell("attitude", True))
    telemetry.subscribe_position(lambda place, *_: tell("position", abs(place.latitude_deg) > 1))
    telemetry.subscribe_fixedwing_metrics(
        lambda metrics, *_: tell("motion", True) if metrics.groundspeed_m_s > 0.1 else None
    )


def accepted(direct: Any, command: float, *params: float) -> None:
    """Send a command for which MAVSDK has no method; raises if it is not accepted."""
    message = import_module("mavsdk.plugins.mavlink_direct.mavlink_direct").MavlinkMessage
    fields: dict[str, float] = {"target_system": 1, "target_component": 1, "command": int(command), "confirmation": 0}
    fields |= {f"param{number}": 0.0 for number in range(1, 8)}
    fields |= {f"param{number}": value for number, value in enumerate(params, start=1)}
    answer = direct.send_command(message("COMMAND_LONG", 0, 0, 1, 1, json.dumps(fields)))
    if json.loads(answer.fields_json)["result"] != 0:
        raise RuntimeError(f"not accepted: {answer.fields_json}")
