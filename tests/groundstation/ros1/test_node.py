"""The script for the system's Python, as far as it goes without ROS; with ROS: tests/e2e/test_ros1.py."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from pathlib import Path

from groundstation.ros1 import node
from groundstation.ros1.process import NODE
from tests.waits import PATIENCE


def test_it_is_python_3_8_and_its_head_imports_no_package() -> None:
    tree = ast.parse(NODE.read_text(), feature_version=(3, 8))
    heads = [each for each in tree.body if isinstance(each, ast.Import | ast.ImportFrom)]
    names = {each.module if isinstance(each, ast.ImportFrom) else each.names[0].name for each in heads}
    assert {str(name).partition(".")[0] for name in names} <= sys.stdlib_module_names
    assert "import groundstation" not in NODE.read_text()


def test_a_python_without_rospy_is_told_in_one_line(tmp_path: Path) -> None:
    words = [sys.executable, "-S", str(NODE), "name", "command=std_msgs/String"]
    ended = subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE, stdin=subprocess.DEVNULL)
    assert ended.returncode == 1
    assert json.loads(ended.stdout) == {"missing": "No module named 'rosgraph'"}
    assert ended.stderr == ""


class Stamp:
    """A Header."""

    __slots__ = ["frame_id", "stamp"]


class Vector:
    """A message with numbers."""

    __slots__ = ["x", "y"]


class Reading:
    """A message with a header, a message and a list."""

    __slots__ = ["covariance", "header", "vector"]

    def __init__(self) -> None:
        self.header, self.vector, self.covariance = Stamp(), Vector(), [0.0]


def test_values_become_fields_and_fields_values() -> None:
    message = Reading()
    values = {"header": [1_500_000, "odom"], "vector": {"x": 1.0, "y": 2.0}, "covariance": [1.0, 2.0]}
    node.fill(message, values, lambda microseconds: microseconds / 1e6)
    assert node.to_values(message) == {
        "header": {"frame_id": "odom", "stamp": 1.5},
        "vector": {"x": 1.0, "y": 2.0},
        "covariance": [1.0, 2.0],
    }
    assert node.to_values(b"for\xffward") == "for\ufffdward"
