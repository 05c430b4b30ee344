"""AccessorySet: all relays and servos of a vehicle, updated in each control cycle."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from vehicle.accessories.output import AccessoryOutput, AccessorySpec, Until


class AccessorySet:
    """The accessories by kind and number. They are opened together with the motors."""

    def __init__(self, specs: Iterable[AccessorySpec] = ()) -> None:
        self._outputs: dict[tuple[str, float], AccessoryOutput] = {
            (spec.kind, spec.number): AccessoryOutput(spec) for spec in specs
        }

    def __iter__(self) -> Iterator[AccessoryOutput]:
        return iter(self._outputs.values())

    @property
    def repeating(self) -> bool:
        """Whether an output repeats, or waits for its target."""
        return any(output.busy for output in self._outputs.values())

    def find(self, kind: str, number: float) -> AccessoryOutput | None:
        """Return the accessory with this number, or None."""
        return self._outputs.get((kind, number))

    def values(self, kind: str) -> dict[int, int]:
        """Return number -> value of the hardware for the open accessories of this kind."""
        return {
            output.spec.number: output.actual
            for output in self
            if output.spec.kind == kind and output.actual is not None
        }

    def open(self) -> None:
        """Open each accessory with its start value. A failure is reported as a fault and does not prevent driving."""
        for output in self:
            output.open()

    def update(self, safe_reason: Callable[[Until], str | None], now: float) -> list[tuple[AccessoryOutput, str]]:
        """Run one control cycle. Returns the outputs that were made safe, with the reason.

        `safe_reason` returns why outputs with this `until` must be safe now, or None. After a failure the other outputs
        wait for the next cycle, so that a dead bus delays a cycle once and not once for each output.
        """
        made_safe = []
        for output in self:
            reason = safe_reason(output.spec.until)
            if reason is not None and output.set_safe():
                made_safe.append((output, reason))
        for output in self:
            if not output.update(now):
                break
        return made_safe

    def close(self) -> None:
        """Make each output safe, then release the hardware. May be called twice."""
        for output in self:
            output.close()
