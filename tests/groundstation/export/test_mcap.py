"""MCAP: read back by rosbags and by the mcap library, with the numbers of pymavlink, in the units and frames of ROS."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from pymavlink import mavutil
from rosbags.highlevel import AnyReader

from dialects import messages as m
from dialects.messages import MESSAGES
from groundstation.export.export import ExportChoice
from groundstation.export.log_time import LogTime, iso_time
from groundstation.export.mcap_file import RosType, type_name
from tests.groundstation.export.logs import (
    ARDUROVER,
    BEAT,
    HEARTBEAT,
    START,
    STEP,
    YAW,
    battery,
    drive,
    gps,
    run,
    sent,
    session,
)

NED = m.LocalPositionNed(0, 1, 2, 3, 0, 0, 0)


def read(path: Path) -> Iterator[tuple[str, int, Any]]:
    """Yield topic, time (ns) and message."""
    with AnyReader([path]) as reader:
        for connection, at, raw in reader.messages():
            yield connection.topic, at, reader.deserialize(raw, connection.msgtype)


def of(path: Path, topic: str) -> list[Any]:
    return [message for name, _, message in read(path) if name == topic]


def exported(tmp_path: Path, log: bytes, choice: ExportChoice | None = None) -> Path:
    (tmp_path / "log.tlog").write_bytes(log)
    run(tmp_path / "log.tlog", ("mcap", tmp_path / "log.mcap"), choice=choice)
    return tmp_path / "log.mcap"


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return exported(tmp_path_factory.mktemp("driven"), drive())


def test_rosbags_reads_the_numbers_that_pymavlink_reads(tmp_path: Path) -> None:
    run(ARDUROVER, ("mcap", tmp_path / "rover.mcap"))
    ours = [(topic, at, message) for topic, at, message in read(tmp_path / "rover.mcap") if topic.count("/") == 3]
    theirs = list(by_pymavlink(ARDUROVER))
    assert len(ours) == len(theirs) > 2000
    for (topic, at, message), other in zip(ours, theirs, strict=True):
        assert topic == f"/sys{other.get_srcSystem()}/comp{other.get_srcComponent()}/{other.get_type()}"
        assert at == pytest.approx(other._timestamp * 1e9, abs=2000)  # pymavlink's times are floats
        for name in other.get_fieldnames():
            assert same(getattr(message, name), getattr(other, name)), (topic, name)


def by_pymavlink(path: Path) -> Iterator[Any]:
    # The dialect is one for the whole process, and tests of scripts choose another.
    log = mavutil.mavlink_connection(str(path), dialect="all")  # type: ignore[no-untyped-call]
    while (message := log.recv_match()) is not None:
        if message.get_msgId() in MESSAGES and message.get_type() != "BAD_DATA":
            yield message
    log.close()


def same(ours: Any, theirs: Any) -> bool:
    if isinstance(theirs, str):
        return bool(ours == theirs)
    if isinstance(theirs, list):
        return len(ours) == len(theirs) and all(map(same, ours.tolist(), theirs))
    return bool(ours == theirs or (math.isnan(ours) and math.isnan(theirs)))


def test_the_mcap_library_finds_profile_schemas_and_counts(driven: Path) -> None:
    with driven.open("rb") as file:
        reader = make_reader(file)
        summary = reader.get_summary()
        assert reader.get_header().profile == "ros2"
        assert summary is not None
        assert summary.statistics is not None
        schemas = {each.name: each for each in summary.schemas.values()}
        position = schemas["mavlink/msg/GlobalPositionInt"]
        assert position.encoding == "ros2msg"
        assert "int32 lat  # degE7\n" in position.data.decode()
        assert all(each.metadata == {"offered_qos_profiles": ""} for each in summary.channels.values())
        for each in summary.schemas.values():
            assert unknown_types(each.name, each.data.decode()) == set()
        (metadata,) = reader.iter_metadata()
        assert metadata.metadata["begin"] == iso_time(START)
        counts = summary.statistics.channel_message_counts
        topics = {each.topic: counts[each.id] for each in summary.channels.values()}
        times = {message.log_time for _, _, message in reader.iter_messages(topics=["/fix"])}
        assert all(message.publish_time == message.log_time for _, _, message in reader.iter_messages())
    assert {topics[name] for name in ("/fix", "/imu", "/odom", "/cmd_vel", "/battery_state")} == {20}
    assert times == {(START + number * STEP) * 1000 for number in range(20)}


def test_fix_has_degrees_ellipsoid_height_and_variances(driven: Path) -> None:
    fix = of(driven, "/fix")[0]
    assert (fix.latitude, fix.longitude, fix.altitude) == (-35.362938, 149.165085, 603.0)
    assert (fix.status.status, fix.header.frame_id) == (0, "gps")
    assert fix.position_covariance[[0, 4, 8]] == pytest.approx([2.25, 2.25, 9.0])
    assert fix.header.stamp.sec * 10**6 + fix.header.stamp.nanosec // 1000 == START


def test_a_fix_that_is_none_has_no_numbers(tmp_path: Path) -> None:
    unknown = [gps(0, 0), gps(2**31 - 1, 2**31 - 1), gps(-353_629_380, 1_491_650_850, fix=1)]
    path = exported(tmp_path, BEAT + b"".join(sent(1, each) for each in unknown))
    fixes = of(path, "/fix")
    assert [each.status.status for each in fixes] == [-1, -1, -1]
    assert all(math.isnan(each.latitude) and math.isnan(each.altitude) for each in fixes)


def test_a_height_above_the_sea_is_not_one_above_the_ellipsoid(tmp_path: Path) -> None:
    path = exported(tmp_path, BEAT + sent(1, gps(-353_629_380, 1_491_650_850, ellipsoid=0)))
    assert math.isnan(of(path, "/fix")[0].altitude)


def test_imu_is_forward_left_up_over_east_north_up(driven: Path) -> None:
    first, last = of(driven, "/imu")[0], of(driven, "/imu")[-1]
    x, y, z, w = (getattr(first.orientation, name) for name in "xyzw")
    forward = (1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w))
    # NED: yaw 30 deg, pitch -0.2 rad (nose down): east sin, north cos, and down.
    level = math.cos(0.2)
    assert forward == pytest.approx((math.sin(YAW) * level, math.cos(YAW) * level, -math.sin(0.2)), abs=1e-6)
    rates = first.angular_velocity
    assert (rates.x, rates.y, rates.z) == pytest.approx((0.01, -0.02, -0.03))
    assert first.linear_acceleration_covariance[0] == -1  # none has arrived yet
    at_rest = last.linear_acceleration
    assert (at_rest.x, at_rest.y, at_rest.z) == pytest.approx((0.980665, 0.4903325, 9.80665))
    assert last.linear_acceleration_covariance[0] == 0


PRIMITIVE = {
    "bool",
    "byte",
    "char",
    "string",
    "float32",
    "float64",
    *(f"{s}int{n}" for s in ("", "u") for n in (8, 16, 32, 64)),
}


def unknown_types(name: str, text: str) -> set[str]:
    """Return the types that a schema uses and does not define, in the form of the MCAP registry for ros2msg."""
    first, *others = text.split("=" * 80 + "\n")
    defined = {each.partition("\n")[0].removeprefix("MSG: ") for each in others}
    lines = [line for each in (first, *(other.partition("\n")[2] for other in others)) for line in each.splitlines()]
    used = {line.split()[0].partition("[")[0] for line in lines if line.strip() and not line.startswith("#")}
    assert name.count("/") == 2
    return used - PRIMITIVE - defined


def test_the_frames_of_each_vehicle_are_placed_by_tf(tmp_path: Path) -> None:
    more = b"".join(
        sent(20 + at, message, 2) for at, message in enumerate((HEARTBEAT, m.Attitude(0, 0, 0, 0, 0, 0, 0), NED))
    )
    path = exported(tmp_path, drive() + more)
    found = [transform for message in of(path, "/tf") for transform in message.transforms]
    first, last = found[0], found[-1]
    assert len(found) == 21
    assert (first.header.frame_id, first.child_frame_id) == ("odom", "base_link")
    assert (last.header.frame_id, last.child_frame_id) == ("sys2/odom", "sys2/base_link")
    place = last.transform.translation
    assert (place.x, place.y, place.z) == (2.0, 1.0, -3.0)
    assert of(path, "/sys2/odom")[0].child_frame_id == "sys2/base_link"


def test_odometry_has_its_velocity_in_the_body(driven: Path) -> None:
    odometry = of(driven, "/odom")[-1]
    at = odometry.pose.pose.position
    assert (at.x, at.y, at.z) == pytest.approx((4.0, 3.0, 0.5))
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("odom", "base_link")
    velocity = odometry.twist.twist.linear  # 1 m/s along the heading, the nose 0.2 rad down
    assert (velocity.x, velocity.y, velocity.z) == pytest.approx(
        (math.cos(0.2), math.sin(0.2) * math.sin(0.1), math.sin(0.2) * math.cos(0.1)), abs=1e-6
    )
    assert odometry.twist.twist.angular.z == pytest.approx(-0.03)


def test_the_demand_is_part_of_full_deflection_left_positive(driven: Path) -> None:
    twist = of(driven, "/cmd_vel")[0]
    assert (twist.linear.x, twist.angular.z) == (0.5, -0.25)  # ArduRover: z throttle, y steering to the right


@pytest.mark.parametrize(("autopilot", "z"), [(3, 400 - 100), (12, 450 - 125)], ids=["ArduCopter", "PX4"])
def test_the_demand_of_a_copter_has_sideways_and_climb(tmp_path: Path, autopilot: int, z: int) -> None:
    beat = sent(0, m.Heartbeat(2, autopilot, 0x81, 5, 4, 3))
    demand = sent(1, m.ManualControl(1, 500, 400, z, -250, 0), 255, 190)
    twist = of(exported(tmp_path, beat + demand), "/cmd_vel")[0]
    assert (twist.linear.x, twist.linear.y, twist.linear.z) == (0.5, -0.4, -0.5)
    assert twist.angular.z == 0.25


def test_battery_discharges_with_a_negative_current(driven: Path) -> None:
    state = of(driven, "/battery_state")[0]
    assert (state.voltage, state.current, state.percentage) == pytest.approx((12.0, -12.34, 0.55))
    assert state.cell_voltage.tolist() == pytest.approx([4.1, 4.0, 3.9])
    assert (state.power_supply_status, state.power_supply_technology, state.temperature) == (2, 3, 21.5)


def test_notes_of_the_station_are_messages(tmp_path: Path) -> None:
    notes = of(exported(tmp_path, session()), "/sys255/comp190/ROVER_STATION_EVENT")
    assert [(each.text, each.throttle, each.steering) for each in notes] == [
        (f"i down {number}", 500, -250) for number in range(3)
    ]


def test_unknown_current_and_percentage_are_nan(tmp_path: Path) -> None:
    path = exported(tmp_path, BEAT + sent(1, battery(current=-1, remaining=-1)))
    state = of(path, "/battery_state")[0]
    assert math.isnan(state.current)
    assert math.isnan(state.percentage)


def test_a_part_of_a_log_knows_the_vehicle_from_what_was_before(tmp_path: Path) -> None:
    part = ExportChoice(LogTime(1_000_000, from_start=True), patterns=("GPS_*", "MANUAL_CONTROL"))
    topics = {topic for topic, _, _ in read(exported(tmp_path, drive(), part))}
    assert topics == {"/sys1/comp1/GPS_RAW_INT", "/sys255/comp190/MANUAL_CONTROL", "/fix", "/cmd_vel"}


def test_a_second_vehicle_has_topics_of_its_own(tmp_path: Path) -> None:
    more = sent(20, HEARTBEAT, 2) + sent(20, battery(), 2)
    topics = {topic for topic, _, _ in read(exported(tmp_path, drive() + more))}
    assert {"/battery_state", "/sys2/battery_state"} <= topics


def test_every_message_has_a_definition_that_rosbags_parses() -> None:
    from rosbags.typesys import get_types_from_msg

    names = set()
    for kind in MESSAGES.values():
        made = RosType(kind)
        fields = get_types_from_msg(made.definition, made.name)[made.name][1]
        assert [name for name, _ in fields] == list(kind.fieldnames)
        names.add(made.name)
    assert len(names) == len(MESSAGES)
    assert type_name("GPS_RAW_INT") == "GpsRawInt"
