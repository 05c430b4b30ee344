"""A vehicle with parameters, for the tests of the parameter protocol."""

from __future__ import annotations

from dataclasses import dataclass, field

from dialects import messages as m
from link.services.pacing import BulkPacer
from link.services.param.float32 import shortest_float32
from link.services.param.server import ParamServer
from link.services.param.values import REAL32
from tests.link.services_world import from_gcs, messages


@dataclass(frozen=True)
class Line:
    name: str
    default: float
    low: float = 0.0
    high: float = 100.0
    unit: str = ""
    description: str = ""
    whole: bool = False
    safety: bool = False
    needs_reboot: bool = False
    read_only: bool = False


TABLE = (
    Line("MAN_TIMEOUT", 0.45, 0.2, 2.0, safety=True),
    Line("MAN_DEADBAND", 3.0, 0.0, 20.0),
    Line("SIXTEEN_LETTERS_", 0.1, 0.1, 0.9),
    Line("INITIAL_MODE", 0, 0, 4, whole=True),
    Line("VERSION", 7, read_only=True),
)


class Memory(dict[str, float]):
    def set(self, name: str, value: float) -> None:
        self[name] = value


@dataclass
class ParamRig:
    """A server, and what it told its vehicle."""

    rate: float = 1e6
    table: tuple[Line, ...] = TABLE
    armed: bool = False
    allowed: bool = True
    changed: list[tuple[str, float]] = field(default_factory=list)
    said: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.values = Memory({line.name: line.default for line in self.table})
        self.server = ParamServer(
            self.table,
            self.values,
            system=1,
            component=1,
            pacer=BulkPacer(lambda peer: self.rate),
            allowed=lambda received, now: self.allowed,
            armed=lambda: self.armed,
            changed=lambda received, name, value: self.changed.append((name, value)),
            refused=lambda received, text, now: self.said.append(text),
        )

    def ask(self, message: m.Message, now: float = 0.0) -> list[m.Message]:
        return messages(self.server.receive(from_gcs(message), now))

    def set(self, name: str, value: float, kind: int = REAL32) -> list[m.Message]:
        return self.ask(m.ParamSet(1, 1, name.encode("latin-1"), value, kind))


def values(answers: list[m.Message]) -> list[tuple[str, float]]:
    return [(each.param_id, shortest_float32(each.param_value)) for each in answers if isinstance(each, m.ParamValue)]


def faults(answers: list[m.Message]) -> list[int]:
    return [each.error for each in answers if isinstance(each, m.ParamError)]


def big_table(count: int) -> tuple[Line, ...]:
    """Parameters P000, P001, ... with their numbers as values."""
    return tuple(Line(f"P{number:03}", float(number), high=1000) for number in range(count))
