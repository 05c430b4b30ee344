"""Keys and tokens against the examples of rmw_zenoh's docs/design.md."""

from __future__ import annotations

import pytest

from groundstation.ros.rmw.names import EntityKind, RmwEndpoint, RmwNode, name_fault, namespace_fault, publisher_tokens

STRING, STRING_HASH = "std_msgs/msg/String", "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
SESSION = "8b20917502ee955ac4476e0266340d5c"
TALKER = RmwNode(2, SESSION, "/", "talker")


def endpoint(node: RmwNode, kind: EntityKind, name: str, qos: str = "::,7:,:,:,,") -> RmwEndpoint:
    return RmwEndpoint(node, 10, kind, name, STRING, STRING_HASH, qos)


def test_the_token_of_a_node() -> None:
    node = RmwNode(2, "aac3178e146ba6f1fc6e6a4085e77f21", "/", "listener")
    assert node.token == "@ros2_lv/2/aac3178e146ba6f1fc6e6a4085e77f21/0/0/NN/%/%/listener"


def test_the_token_of_a_publisher() -> None:
    assert endpoint(TALKER, EntityKind.PUBLISHER, "/chatter").token == (
        f"@ros2_lv/2/{SESSION}/0/10/MP/%/%/talker/%chatter/std_msgs::msg::dds_::String_/{STRING_HASH}/::,7:,:,:,,"
    )


def test_the_token_of_a_service() -> None:
    node = RmwNode(2, "f9980ee0495eaafb3e38f0d19e2eae12", "/", "add_two_ints_server")
    made = RmwEndpoint(node, 10, EntityKind.SERVICE, "/add_two_ints", "example_interfaces/srv/AddTwoInts", "RIHS01_e1")
    assert made.token == (
        "@ros2_lv/2/f9980ee0495eaafb3e38f0d19e2eae12/0/10/SS/%/%/add_two_ints_server/%add_two_ints/"
        "example_interfaces::srv::dds_::AddTwoInts_/RIHS01_e1/::,10:,:,:,,"
    )
    assert made.key == "2/add_two_ints/example_interfaces::srv::dds_::AddTwoInts_/RIHS01_e1"


def test_a_namespace_is_in_keys_and_mangled_in_tokens() -> None:
    node = RmwNode(0, SESSION, "/robot1", "talker")
    made = endpoint(node, EntityKind.SUBSCRIPTION, node.resolve("chatter"))
    assert made.key == f"0/robot1/chatter/std_msgs::msg::dds_::String_/{STRING_HASH}"
    assert made.token.startswith(f"@ros2_lv/0/{SESSION}/0/10/MS/%/%robot1/talker/%robot1%chatter/")


@pytest.mark.parametrize(
    ("namespace", "name", "whole"),
    [
        ("/", "cmd_vel", "/cmd_vel"),
        ("/a", "cmd_vel", "/a/cmd_vel"),
        ("/a", "/rosout", "/rosout"),
        ("/", "~/arm", "/talker/arm"),
        ("/a/b", "~/arm", "/a/b/talker/arm"),
    ],
)
def test_names_are_resolved_as_in_ros(namespace: str, name: str, whole: str) -> None:
    assert RmwNode(0, SESSION, namespace, "talker").resolve(name) == whole


def test_tokens_of_all_publishers_have_as_many_parts_as_one() -> None:
    token = endpoint(TALKER, EntityKind.PUBLISHER, "/chatter").token
    pattern = publisher_tokens(2, "/chatter")
    assert all(part in ("*", each) for part, each in zip(pattern.split("/"), token.split("/"), strict=True))


@pytest.mark.parametrize("name", ["", "1a", "a b", "a/b", "a*", "a%", "ä", "a\n"])
def test_names_that_would_break_a_key_are_refused(name: str) -> None:
    assert name_fault(name)
    assert namespace_fault("x" + name)


def test_usual_names_pass() -> None:
    assert name_fault("mavhelm_1") is None
    assert [namespace_fault(each) for each in ("/", "/rover", "/fleet/rover_1")] == [None] * 3
    assert namespace_fault("/a//*")
