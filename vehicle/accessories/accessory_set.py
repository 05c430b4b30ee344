"""All accessories of a vehicle: which there are, what may be asked of each, and what time does to them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from vehicle.accessories.output import AccessoryOutput, AccessorySpec, Until


class AccessorySet:
    """Opened when the motors are; before that nothing is given."""

    def __init__(self, outputs: Iterable[AccessorySpec] = ()) -> None:
        self._outlets: dict[tuple[str, float], AccessoryOutput] = {
            (output.kind, output.number): AccessoryOutput(output) for output in outputs
        }

    def __iter__(self) -> Iterator[AccessoryOutput]:
        return iter(self._outlets.values())

    def find(self, kind: str, number: float) -> AccessoryOutput | None:
        """The one of this number; None where there is none."""
        return self._outlets.get((kind, number))

    def values(self, kind: str) -> dict[int, int]:
        """Number -> what the hardware has, of those that are open."""
        return {
            outlet.spec.number: outlet.actual
            for outlet in self
            if outlet.spec.kind == kind and outlet.actual is not None
        }

    def open(self) -> None:
        """Each with its first value. One that does not open is told as a fault, and keeps nobody from driving."""
        for outlet in self:
            outlet.open()

    def update(self, secured: Callable[[Until], str | None], now: float) -> list[tuple[AccessoryOutput, str]]:
        """One cycle. `secured` says why those that keep what they have until then must be safe now, or None; which of
        them were not is returned, and why they are now.

        After a failure the others wait for the next cycle, so that a dead bus costs one wait in a cycle and not one
        for each.
        """
        ended = []
        for outlet in self:
            why = secured(outlet.spec.until)
            if why is not None and outlet.set_safe():
                ended.append((outlet, why))
        for outlet in self:
            if not outlet.update(now):
                break
        return ended

    def close(self) -> None:
        """Each safe, and let go. May come twice."""
        for outlet in self:
            outlet.close()
