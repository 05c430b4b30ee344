"""Hashes and CDR against published values; bytes that are not a message."""

from __future__ import annotations

import struct

import pytest

from groundstation.ros.services import SERVICES
from groundstation.ros.types import BadMessageError, RosTypes

TWIST = "geometry_msgs/msg/Twist"
PUBLISHED_HASHES = {
    TWIST: "9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a",
    "geometry_msgs/msg/TwistStamped": "5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64",
    "std_msgs/msg/String": "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
    "std_srvs/srv/SetBool": "abe9e4bb6b41b40e6789712c00ec8871923e089af3f667a79992a428cff2da0a",
    "rcl_interfaces/srv/ListParameters": "3e6062bfbb27bfb8730d4cef2558221f51a11646d78e7bb30a1e83afac3aad9d",
    "rcl_interfaces/srv/GetParameters": "bf9803d5c74cf989a5de3e0c2e99444599a627c7ff75f97b8c05b01003675cbc",
    "rcl_interfaces/srv/GetParameterTypes": "da199c878688b3e530bdfe3ca8f74cb9fa0c303101e980a9e8f260e25e1c80ca",
    "rcl_interfaces/srv/SetParameters": "56eed9a67e169f9cb6c1f987bc88f868c14a8fc9f743a263bc734c154015d7e0",
    "rcl_interfaces/srv/SetParametersAtomically": "0e192ef259c07fc3c07a13191d27002222e65e00ccec653ca05e856f79285fcd",
    "rcl_interfaces/srv/DescribeParameters": "845b484d71eb0673dae682f2e3ba3c4851a65a3dcfb97bddd82c5b57e91e4cff",
}
"""Type -> its hash in ROS 2 Jazzy: docs/design.md of rmw_zenoh, `ros2 topic info --verbose`, share/*/srv/*.json."""


@pytest.fixture(scope="module")
def types() -> RosTypes:
    made = RosTypes()
    for name, parts in SERVICES.items():
        made.register_service(name, *parts)
    made.register_service("example_interfaces/srv/AddTwoInts", "int64 a\nint64 b\n", "int64 sum\n")
    made.register_service("std_srvs/srv/Trigger", "", "bool success\nstring message\n")
    return made


@pytest.mark.parametrize("kind", PUBLISHED_HASHES)
def test_hashes_are_those_of_ros(types: RosTypes, kind: str) -> None:
    assert types.hash(kind) == f"RIHS01_{PUBLISHED_HASHES[kind]}"


def test_every_service_has_a_published_hash() -> None:
    assert SERVICES.keys() <= PUBLISHED_HASHES.keys()


def test_the_rmw_zenoh_example_and_a_service_without_a_request(types: RosTypes) -> None:
    add_two_ints = "RIHS01_e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a"
    assert types.hash("example_interfaces/srv/AddTwoInts") == add_two_ints
    trigger = "RIHS01_eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f"
    assert types.hash("std_srvs/srv/Trigger") == trigger


def test_a_twist_is_a_header_of_cdr_and_six_doubles(types: RosTypes) -> None:
    vector = {"x": 1.0, "y": 2.0, "z": 3.0}
    data = types.encode(TWIST, {"linear": vector, "angular": {"x": 4.0, "y": 5.0, "z": 6.0}})
    assert data == b"\x00\x01\x00\x00" + struct.pack("<6d", 1, 2, 3, 4, 5, 6)
    assert types.decode(TWIST, data).angular.z == 6.0


BATTERY_OF_CYCLONEDDS = bytes.fromhex(
    "00010000010000000065cd1d0a000000626173655f6c696e6b000000000048410000a2410000c0bf00000000000000000000000000"
    "00403f02000301030000000000804000008840000088400000000002000000300000000100000000"
)
"""The BatteryState below as cyclonedds 11.0.1 serializes it."""


def test_a_battery_state_has_the_bytes_that_cyclonedds_makes(types: RosTypes) -> None:
    values = {
        "header": (1_500_000, "base_link"), "voltage": 12.5, "temperature": 20.25, "current": -1.5, "charge": 0.0,
        "capacity": 0.0, "design_capacity": 0.0, "percentage": 0.75, "power_supply_status": 2,
        "power_supply_health": 0, "power_supply_technology": 3, "present": True, "cell_voltage": [4.0, 4.25, 4.25],
        "cell_temperature": [], "location": "0", "serial_number": "",
    }  # fmt: skip
    assert types.encode("sensor_msgs/msg/BatteryState", values) == BATTERY_OF_CYCLONEDDS
    listed = values | {"header": [1_500_000, "base_link"]}  # as msgpack hands it on
    assert types.encode("sensor_msgs/msg/BatteryState", listed) == BATTERY_OF_CYCLONEDDS
    decoded = types.decode("sensor_msgs/msg/BatteryState", BATTERY_OF_CYCLONEDDS)
    stamp = {"sec": 1, "nanosec": 500_000_000}
    assert types.to_plain(decoded) == values | {"header": {"stamp": stamp, "frame_id": "base_link"}}


def test_a_string_in_both_byte_orders(types: RosTypes) -> None:
    assert types.decode("std_msgs/msg/String", b"\x00\x01\x00\x00\x05\x00\x00\x00stop\x00").data == "stop"
    assert types.decode("std_msgs/msg/String", b"\x00\x00\x00\x00\x00\x00\x00\x05stop\x00").data == "stop"


@pytest.mark.parametrize("data", [b"", b"\x00", b"\x00\x01\x00\x00", b"\x00\x01\x00\x00" + b"\xff" * 9, b"\xff" * 52])
def test_bytes_that_are_no_message_are_refused_in_one_line(types: RosTypes, data: bytes) -> None:
    for kind in ("std_msgs/msg/String", "rcl_interfaces/srv/SetParameters_Request"):
        with pytest.raises(BadMessageError) as error:
            types.decode(kind, data)
        assert "\n" not in str(error.value)


def test_a_response_goes_there_and_back(types: RosTypes) -> None:
    kind = "std_srvs/srv/SetBool_Response"
    answer = types.decode(kind, types.encode(kind, {"success": True, "message": "Rover 1 is armed"}))
    assert (answer.success, answer.message) == (True, "Rover 1 is armed")
