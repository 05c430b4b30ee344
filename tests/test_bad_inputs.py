"""The bad inputs that the vehicle was designed against: each has a test with its number in the name."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

TESTS = Path(__file__).parent
BAD_INPUTS = {
    31: "MANUAL_CONTROL for target 0 or another system",
    32: "... from a ground station that is not in control",
    33: "... with an axis of 32767",
    34: "... with an axis beyond 1000",
    35: "... at full throttle as the first after arming",
    36: "... the same packet again and again",
    37: "... from two ground stations by turns",
    38: "... once a second",
    39: "... with accessory axes and buttons",
    40: "... while disarmed or stopped",
    41: "... from full ahead to full reverse at once",
    42: "RC_CHANNELS_OVERRIDE with pulses that are none, and channels that are given back",
    43: "a setpoint with a used value that is no number",
    44: "... of 1e30 m/s",
    45: "... with frames and masks that are not offered",
    46: "... in another mode, disarmed, or from another station",
    47: "... that was overtaken, or is old when it arrives",
    48: "arming with 0.5, NaN, 2",
    49: "arming by force during an emergency stop",
    50: "a command for another component",
    51: "arming and disarming for all systems",
    52: "the same command ten times",
    53: "DO_REPOSITION to nowhere",
    54: "SET_MESSAGE_INTERVAL of 1 us for everything",
    55: "REQUEST_MESSAGE of what is no message",
    56: "motor tests too fast, too long, and of NaN",
    57: "a restart while armed",
    58: "an unknown command",
    59: "a termination that is not meant",
    60: "PARAM_SET with bad values, types and names",
    61: "PARAM_SET of safety settings while armed",
    62: "PARAM_REQUEST_READ of what is not there",
    63: "PARAM_REQUEST_LIST again and again",
    64: "a power cut while parameters are saved, and a damaged file",
    65: "MISSION_COUNT of 65535",
    66: "an upload that falls silent",
    67: "mission items out of order, twice, and of another station",
    68: "mission items that are none",
    69: "an upload of the mission that is driven",
    70: "DO_JUMP in a circle",
    71: "file names that lead out",
    72: "FTP sizes, offsets and sessions that cannot be",
    73: "unknown FTP questions",
    74: "an FTP question said again",
}
"""Number -> input. Bytes, links, and system faults have tests of their own in tests/link and tests/e2e."""


def numbered() -> dict[int, list[str]]:
    """Number -> tests named test_NUMBER_..."""
    found: dict[int, list[str]] = {}
    for file in sorted(TESTS.rglob("test_*.py")):
        for number, name in re.findall(r"def test_(\d+)_(\w+)\(", file.read_text()):
            found.setdefault(int(number), []).append(f"{file.relative_to(TESTS)}: {name}")
    return found


@pytest.mark.parametrize(("number", "what"), BAD_INPUTS.items())
def test_it_has_a_test(number: int, what: str) -> None:
    assert numbered().get(number), f"no test is named test_{number}_...: {what}"
