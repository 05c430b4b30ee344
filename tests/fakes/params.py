"""Parameters of a fake vehicle, with the encodings and the manners of ArduPilot and of PX4.

Measured on ArduRover 4.7-dev: values are cast to float, unknown names are met with silence, the echo of a set has no
index, `@PARAM/param.pck` announces a size that is too large.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from dialects import messages as m
from dialects.enums import Autopilot
from link.core import Received

if TYPE_CHECKING:
    from tests.fakes.vehicle import FakeVehicle

INTEGERS = {1: "<Bxxx", 2: "<bxxx", 3: "<Hxx", 4: "<hxx", 5: "<I", 6: "<i"}
"""MAV_PARAM_TYPE -> its bytes in the float, as PX4 packs them."""
INT32, REAL32 = 6, 9
NO_INDEX = 65535


@dataclass
class Param:
    """One parameter."""

    value: float
    kind: int = REAL32
    default: float | None = None
    read_only: bool = False


class Params(dict[str, Param]):
    """Name -> parameter. A plain number becomes a REAL32. Without any parameter, nothing is answered."""

    def __init__(self, values: Mapping[str, Param | float] | None = None) -> None:
        super().__init__()
        self.withheld: set[str] = set()
        """Names whose PARAM_VALUE is never sent."""
        self.update(values or {})

    def __setitem__(self, name: str, value: Param | float) -> None:
        super().__setitem__(name, value if isinstance(value, Param) else Param(float(value)))

    def __ior__(self, values: Mapping[str, Param | float]) -> Params:  # type: ignore[override,misc]
        self.update(values)
        return self

    def update(self, values: Mapping[str, Param | float]) -> None:  # type: ignore[override]
        """Set several."""
        for name, value in values.items():
            self[name] = value

    def replace(self, values: Mapping[str, Param | float]) -> None:
        """Have these and no other."""
        self.clear()
        self.update(values)

    def receive(self, vehicle: FakeVehicle, received: Received, now: float) -> None:
        """Answer PARAM_REQUEST_LIST, PARAM_REQUEST_READ and PARAM_SET."""
        match received.message:
            case m.ParamRequestList() if self:
                self._list(vehicle)
            case m.ParamRequestRead() as message:
                names = list(self)
                index = message.param_index
                self._send(vehicle, message.param_id if index < 0 else names[index] if index < len(names) else "")
            case m.ParamSet() as message if self:
                self._set(vehicle, message)

    def tick(self, vehicle: FakeVehicle, now: float) -> None:
        """Send nothing of its own."""

    def _list(self, vehicle: FakeVehicle) -> None:
        if vehicle.autopilot == Autopilot.PX4:
            vehicle.send(m.ParamValue(b"_HASH_CHECK", 1.5, 5, len(self), NO_INDEX))
        for name in list(self):
            self._send(vehicle, name)

    def _send(self, vehicle: FakeVehicle, name: str, *, indexed: bool = True) -> None:
        if name not in self or name in self.withheld:
            return
        param = self[name]
        wire = param.value
        if vehicle.autopilot == Autopilot.PX4 and param.kind in INTEGERS:
            (wire,) = struct.unpack("<f", struct.pack(INTEGERS[param.kind], int(param.value)))
        index = list(self).index(name) if indexed else NO_INDEX
        vehicle.send(m.ParamValue(name.encode("latin-1"), wire, param.kind, len(self), index))

    def _set(self, vehicle: FakeVehicle, message: m.ParamSet) -> None:
        name, value = message.param_id, message.param_value
        px4 = vehicle.autopilot == Autopilot.PX4
        param = self.get(name)
        if param is None:
            if px4:
                vehicle.say(f"[pm] unknown param: {name}")
            return
        if px4 and message.param_type != param.kind:
            vehicle.say("[pm] param types mismatch")
            return
        if px4 and param.kind in INTEGERS:
            (value,) = struct.unpack(INTEGERS[param.kind], struct.pack("<f", value))
        if param.read_only:
            vehicle.say(f"{name} is read-only")
        else:
            param.value = float(int(value)) if param.kind in INTEGERS else value
        self._send(vehicle, name, indexed=vehicle.autopilot != Autopilot.ARDUPILOT)

    def packed(self) -> bytes:
        """Return param.pck with defaults, as ArduPilot packs it."""
        packed, before = struct.pack("<HHH", 0x671C, len(self), len(self)), b""
        for name, param in self.items():
            kind, form = {2: (1, "<b"), 4: (2, "<h"), 6: (3, "<i")}.get(param.kind, (4, "<f"))
            raw, flag = name.encode("latin-1"), 0 if param.default is None else 0x10
            shared = 0
            while shared < min(len(raw) - 1, len(before), 15) and raw[shared] == before[shared]:
                shared += 1
            packed += bytes([kind | flag, shared | (len(raw) - shared - 1) << 4]) + raw[shared:]
            for value in (param.value, param.default):
                if value is not None:
                    packed += struct.pack(form, value if kind == 4 else int(value))
            before = raw
        return packed


def many_params(count: int) -> Iterator[tuple[str, Param]]:
    """Yield parameters of all ArduPilot types, with names that share beginnings."""
    kinds = ((2, -127), (4, -3000), (INT32, 2_000_000_000), (REAL32, 0.1))
    for number in range(count):
        kind, value = kinds[number % 4]
        default = None if number % 3 else value - 1
        yield f"GRP{number // 30:02}_PARAM_{number:04}"[:16], Param(float(value), kind, default)
