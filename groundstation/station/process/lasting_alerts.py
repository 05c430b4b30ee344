"""Lasting alerts for the log file: settings, link problems and conflicts, which the screen shows while they hold."""

from __future__ import annotations

from collections.abc import Iterator

from groundstation.snapshot import Snapshot

MOST = 200
"""Texts that are written in one session: a vehicle could invent new ones for ever."""


class LastingAlerts:
    """Finds the alerts that were not written yet."""

    def __init__(self) -> None:
        self._written: set[str] = set()

    def new_in(self, snapshot: Snapshot) -> list[str]:
        """Return the texts that this session has not had yet."""
        new = [text for text in dict.fromkeys(_lasting(snapshot)) if text not in self._written]
        new = new[: MOST - len(self._written)]
        self._written.update(new)
        return new


def _lasting(snapshot: Snapshot) -> Iterator[str]:
    if snapshot.id_conflict:
        yield snapshot.id_conflict
    for link in snapshot.links:
        if link.problem:
            yield f"{link.name}: {link.problem}"
    vehicle = snapshot.vehicle
    if vehicle is None:
        return
    if vehicle.obeys is not None:
        yield f"{vehicle.name}: {vehicle.obeys}"
    for warning in vehicle.warnings:
        yield f"{vehicle.name}: {warning}"
