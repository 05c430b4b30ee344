"""A rover in the field: the bench's rover and drivers, its sensors a simulated body that does what it says."""

from __future__ import annotations

from msgspec.structs import replace

from dialects import messages as m
from dialects.axes import Axes
from dialects.enums import Command, DriveType, Result
from dialects.modes import Mode
from tests.vehicle.bench import CYCLE, DRIVER, NEUTRAL, Bench
from vehicle.navigation.estimate import Estimate
from vehicle.navigation.geo import Origin, Point
from vehicle.sim.body import SimulatedBody, SimulatedHome, Slope
from vehicle.sim.chassis import CHASSIS, ChassisDimensions
from vehicle.sim.noise import SensorNoise

HOME = SimulatedHome(50.0, 8.0, 100.0)
GROUND = Origin(HOME.latitude, HOME.longitude)
TWIST = 0x5C7
"""Mask of velocity and yaw rate."""
ONLY_PLACE = 0xDF8


class Field(Bench):
    """`truth` is where the plant is; the rover knows only what its sensors say."""

    def __init__(self, seed: int | None = 1, noise: SensorNoise | None = None, slope: Slope | None = None,
                 **params: float) -> None:  # fmt: skip
        chassis = CHASSIS[DriveType(int(params.get("DRIVE_TYPE", 1)))](
            ChassisDimensions(top_speed=params.get("SPEED_MAX", 1.5))
        )
        self.body: SimulatedBody | None = None
        self.track: list[Point] = []
        self.blind: dict[str, object] = {}
        """Readings of sensors that are broken, or not there."""
        super().__init__(**params)
        self.body = SimulatedBody(lambda: self.throttles, chassis=chassis, home=HOME, seed=seed, noise=noise,
                                  slope=slope)  # fmt: skip
        self.wait(2.0)

    @property
    def truth(self) -> Point:
        assert self.body is not None
        return Point(self.body.motion.north, self.body.motion.east)

    @property
    def yaw(self) -> float:
        assert self.body is not None
        return self.body.motion.yaw

    @property
    def speed(self) -> float:
        assert self.body is not None
        return self.body.motion.speed

    @property
    def estimate(self) -> Estimate:
        return self.rover._navigator.estimate

    def cycle(self) -> None:
        if self.body is not None:
            self.readings = replace(self.body.read(self.now), **self.blind)
            self.track.append(self.truth)
        super().cycle()

    def begin(self, mode: Mode, system: int = DRIVER) -> None:
        """Armed, and then the mode."""
        assert self.arm(system) is Result.ACCEPTED
        assert self.set_mode(mode, system) is Result.ACCEPTED, self.texts

    def beat(self, seconds: float) -> None:
        """Time passes with a ground station that lives but says nothing else."""
        end = self.now + seconds
        while self.now < end - 1e-9:
            self.heartbeat()
            self.wait(min(1.0, end - self.now))

    def twist(self, speed: float, turn_rate: float = 0.0, *, frame: int = 8, mask: int = TWIST, boot_ms: int = 0,
              system: int = DRIVER) -> None:  # fmt: skip
        self.say(
            m.SetPositionTargetLocalNed(boot_ms, 1, 1, frame, mask, 0, 0, 0, speed, 0, 0, 0, 0, 0, 0, turn_rate),
            system,
        )

    def stream(self, seconds: float, speed: float, turn_rate: float = 0.0) -> None:
        """A twist at 20 Hz."""
        end = self.now + seconds
        while self.now < end - 1e-9:
            self.twist(speed, turn_rate)
            self.wait(0.06)

    def goto(self, north: float, east: float, *, frame: int = 1, mask: int = ONLY_PLACE) -> None:
        self.say(m.SetPositionTargetLocalNed(0, 1, 1, frame, mask, north, east, 0, 0, 0, 0, 0, 0, 0, 0, 0))

    def reposition(self, place: Point, *, frame: int = 6, speed: float = -1, flags: int = 1) -> Result:
        latitude, longitude = GROUND.to_global(place)
        return self.command_int(
            Command.DO_REPOSITION, speed, flags, x=round(latitude * 1e7), y=round(longitude * 1e7), frame=frame
        )

    def command_int(self, command: int, *params: float, x: int = 0, y: int = 0, z: float = 0.0, frame: int = 6,
                    system: int = DRIVER) -> Result:  # fmt: skip
        one, two, three, four = (*params, *(0.0,) * (4 - len(params)))
        self.say(m.CommandInt(1, 1, frame, command, 0, 0, one, two, three, four, x, y, z), system)
        return Result(self.newest(m.CommandAck).result)

    def until(self, place: Point, within: float, radius: float = 0.7) -> None:
        """Drive on until the truth is near `place`."""
        end = self.now + within
        while self.truth.distance(place) > radius:
            assert self.now < end, f"{self.truth} is not {place}; {self.texts}"
            self.heartbeat()
            self.wait(0.2)

    def stands_for(self, seconds: float) -> bool:
        """No motor turns in all that time, whatever the driver's stick says."""
        still = True
        for _ in range(round(seconds / CYCLE)):
            self.wait(CYCLE)
            still &= not self.turning
        return still


def away() -> Field:
    """Return an armed rover that was driven around a corner in MANUAL."""
    field = Field()
    field.arm()
    field.wait(0.2, NEUTRAL)
    field.wait(10.0, Axes(0.5))
    field.wait(1.0, Axes(0.0, 0.4))
    field.wait(8.0, Axes(0.5))
    field.wait(0.5, NEUTRAL)
    assert field.truth.distance(Point(0.0, 0.0)) > 6.0
    return field
