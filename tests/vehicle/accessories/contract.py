"""What every accessory driver must pass: its test subclasses AccessoryContract and gives the fixture `bench`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import pytest

from vehicle.accessories import Accessory


@dataclass
class Bench:
    """A driver on the bench, with something that looks at its wire."""

    make: Callable[[int], Accessory]
    gives: Callable[[], int]
    """What is at its wire: of a relay 0 or 1, of a servo us, 0 for no pulses."""
    values: tuple[int, ...]
    """To try."""
    tolerance: int = 0
    """us."""

    def has(self, value: int) -> bool:
        """Nothing at all, or about so much."""
        return self.gives() == value if value == 0 else abs(self.gives() - value) <= self.tolerance


class AccessoryContract:
    """Subclass it, name the class Test..., and give the fixture `bench`."""

    @pytest.fixture
    def bench(self) -> Bench:
        raise NotImplementedError

    def test_begins_with_the_value_it_is_made_with(self, bench: Bench) -> None:
        for value in bench.values:
            accessory = bench.make(value)
            assert bench.has(value)
            accessory.close()

    def test_gives_what_it_is_told(self, bench: Bench) -> None:
        accessory = bench.make(0)
        for value in (*bench.values, 0, *reversed(bench.values)):
            accessory.set(value)
            assert bench.has(value)
        accessory.close()

    def test_close_may_come_twice(self, bench: Bench) -> None:
        accessory = bench.make(0)
        accessory.set(bench.values[0])
        accessory.close()
        accessory.close()
