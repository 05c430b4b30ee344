"""The table of the bridge fits a terminal of 80 columns."""

from __future__ import annotations

import io

import pytest
from msgspec.structs import replace
from rich.console import Console

from link.bridge.status import BridgeStatus, LinkStatus, RouteStatus
from link.bridge.table import NAME_WIDTH, build_tables, format_count


def test_the_table_is_whole_on_a_terminal_of_80_columns() -> None:
    """Every column, every name and every number, of a bridge that has run for weeks."""
    busy = LinkStatus(
        "serial:/dev/serial/by-id/usb-FTDI_FT232R-if00-port0:57600", None, 12, 3456.7, 98765.4, 3456.7, 1234567.0,
        1.0, 40_000_000, 12345678, 99999, 123456, 7654321,
    )  # fmt: skip
    quiet = replace(busy, endpoint="udpin:0.0.0.0:14550", peers=0)
    route = RouteStatus(255, 190, busy.endpoint, "192.168.100.200:54321", 1234.5, 1000.0, 1234567)
    console = Console(file=io.StringIO(), width=80, height=60, force_terminal=True, color_system=None)
    console.print(build_tables(BridgeStatus((busy, quiet), (route,), 0, 0)))
    lines = console.file.getvalue().splitlines()  # type: ignore[attr-defined]
    shown = "".join("".join(line[: NAME_WIDTH + 2].split()) for line in lines)
    assert busy.endpoint in shown
    assert quiet.endpoint in shown
    words = " ".join(lines).split()
    assert {"12", "3457", "98765", "1235k", "100.0%", "12.3M", "99999", "123k", "7654k"} <= set(words)
    assert {"peers", "loss", "CRC", "unknown", "dropped", "system", "component", "lost", "silent"} <= set(words)
    assert {"255", "190", "1000", "1234.5"} <= set(words)
    assert "…" not in "".join(lines)
    assert all(len(line) <= 80 for line in lines)


@pytest.mark.parametrize(
    ("number", "text"),
    [(0, "0"), (7.6, "8"), (99999, "99999"), (99999.6, "100k"), (123456, "123k"), (9_999_999, "10.0M"), (5e7, "50.0M"),
     (999.9e6, "1000M"), (12e9, "12.0G")],
)  # fmt: skip
def test_long_numbers_are_short(number: float, text: str) -> None:
    assert format_count(number) == text
    assert len(text) <= 5
