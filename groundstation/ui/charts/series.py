"""Series: one line of a chart, a field as it is or derived from it: scaled, its rate, or the difference of two."""

from __future__ import annotations

from bisect import bisect_right

import msgspec

from groundstation.ui.charts.points import Points, PointStore
from groundstation.views.charts import FieldId, FieldInfo

LEAST_STEP = 0.15
"""s between two points of which the rate is taken: those of one slot of the station are closer."""


class SeriesSpec(msgspec.Struct, frozen=True):
    """What a line shows: (field - minus) x factor, or its change a second."""

    field: FieldId
    factor: float = 1.0
    minus: FieldId | None = None
    rate: bool = False

    @property
    def fields(self) -> tuple[FieldId, ...]:
        """Fields that it needs."""
        return (self.field,) if self.minus is None else (self.field, self.minus)

    @property
    def is_plain(self) -> bool:
        """The values of the field as they are."""
        return self.minus is None and not self.rate and self.factor == 1.0

    @property
    def label(self) -> str:
        """Short name, e.g. "VFR_HUD.groundspeed", "rate of ATTITUDE.yaw x57.3"."""
        name = ("> " if self.field.sent else "") + self.field.name
        name = name if self.minus is None else f"{name} - {self.minus.name}"
        factor = "" if self.factor == 1.0 else f" ×{self.factor:g}"
        return f"{'rate of ' if self.rate else ''}{name}{factor}"

    def unit(self, info: FieldInfo | None) -> str:
        """Return the unit of its values: not that of the field where a factor changes it."""
        unit = "" if info is None or self.factor != 1.0 else info.unit
        return f"{unit}/s" if self.rate else unit

    def decimals(self, info: FieldInfo | None) -> int:
        """Return the decimals of its values."""
        decimals = 2 if info is None else info.decimals
        return decimals if self.is_plain else max(2, decimals)


class Line:
    """The points of a series. Those of a field are used as they are; derived ones are computed as they arrive."""

    def __init__(self, spec: SeriesSpec) -> None:
        self.spec = spec
        self._derived = Points()
        self._source: Points | None = None
        self._done = 0
        """Points of the field that are computed."""

    def update(self, store: PointStore) -> Points:
        """Return the points of the series, with all that have arrived."""
        source = store.fields.get(self.spec.field)
        if source is None:
            return self._derived
        if self.spec.is_plain:
            return source
        if source is not self._source:
            self._source, self._derived, self._done = source, Points(), source.dropped
        other = None if self.spec.minus is None else store.fields.get(self.spec.minus)
        self._derive(source, other)
        self._derived.forget(store.now - 600.0)
        return self._derived

    def _derive(self, source: Points, other: Points | None) -> None:
        before = max(self._done - source.dropped, 0)
        for index in range(before, len(source.times)):
            at = source.times[index]
            if other is not None and (not other.times or other.times[-1] < at):
                break  # the other value of this time has not arrived yet
            self._done = source.dropped + index + 1
            value = self._value(source, index, other)
            if value is not None:
                self._derived.add_known(at, value * self.spec.factor, gap=bool(source.breaks[index]))

    def _value(self, source: Points, index: int, other: Points | None) -> float | None:
        if self.spec.rate:
            return _rate(source, index)
        if self.spec.minus is None:
            return source.values[index]
        subtracted = other.value_at(source.times[index]) if other is not None else None
        return None if subtracted is None else source.values[index] - subtracted


def _rate(source: Points, index: int) -> float | None:
    """Return the change a second up to a point; None for the first one behind a gap."""
    at = source.times[index]
    first = bisect_right(source.times, at - LEAST_STEP) - 1
    if first < 0 or any(source.breaks[first + 1 : index + 1]):
        return None
    return (source.values[index] - source.values[first]) / (at - source.times[first])
