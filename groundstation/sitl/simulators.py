"""SIMULATORS: the simulated rovers that can be started. A new one is a row here."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec

DEFAULT_SYSTEM = 1
"""System id of `mavhelm vehicle --sim` without --system."""


class SimulatorRow(msgspec.Struct, frozen=True):
    """One choice of the Connect screen."""

    kind: str
    """Its name in StartSimulator."""
    key: str
    label: str
    help: str
    options: tuple[tuple[str, ...], ...]
    """Options of `mavhelm vehicle --sim`, one tuple for each process."""


SIMULATORS: tuple[SimulatorRow, ...] = (
    SimulatorRow("rover", "s", "rover", "skid steering", ((),)),
    SimulatorRow("car", "c", "car", "steered wheels", (("--param", "DRIVE_TYPE=2"),)),
    SimulatorRow("mecanum", "m", "mecanum", "moves sideways", (("--param", "DRIVE_TYPE=4"),)),
    SimulatorRow("low", "l", "battery low", "drops into HOLD", (("--sim-battery", "0.1"),)),
    SimulatorRow("three", "v", "three rovers", "ids 1 2 3",
                 (("--system", "1"), ("--system", "2", "--sim-seed", "2"), ("--system", "3", "--sim-seed", "3"))),
)  # fmt: skip
"""In the order of the screen; ENTER with nothing heard starts the first."""


def find_system(options: Sequence[str]) -> int:
    """Return the system id that a simulator with these options has."""
    return int(options[options.index("--system") + 1]) if "--system" in options else DEFAULT_SYSTEM


def find_simulator(kind: str) -> SimulatorRow:
    """Return the row of this name; the first one for a name that is not there."""
    return next((row for row in SIMULATORS if row.kind == kind), SIMULATORS[0])
