"""The station process with a bug, triggered by the drive style "fail in <method>". Run as `python -m`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from groundstation.host import station_process, station_run
from groundstation.intents.driving import SetStyle
from groundstation.intents.union import AnyIntent
from groundstation.station.station import Station

ORDER = "fail in "


class CrashingStation(Station):
    """Raises in the named method from then on."""

    _bug = ""

    def handle_intent(self, intent: AnyIntent, now: float, *, read_at: float | None = None) -> None:
        if isinstance(intent, SetStyle) and intent.style.startswith(ORDER):
            self._bug = intent.style.removeprefix(ORDER)
        self._work("intend")
        super().handle_intent(intent, now, read_at=read_at)

    def _work(self, method: str) -> None:
        if self._bug == method:
            raise ZeroDivisionError("a bug\nof ours")


def _with_bug(name: str) -> Callable[..., Any]:
    method = getattr(Station, name)

    def call(self: CrashingStation, *arguments: Any) -> Any:
        self._work(name)
        return method(self, *arguments)

    return call


for _name in ("receive", "tick", "observe", "messages_to_send", "handle_sent", "snapshot"):
    setattr(CrashingStation, _name, _with_bug(_name))

if __name__ == "__main__":
    vars(station_run)["Station"] = CrashingStation
    raise SystemExit(station_process.main())
