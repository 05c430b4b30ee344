"""Builds ONBOARD_COMPUTER_STATUS: load, memory and temperature of the companion computer."""

from __future__ import annotations

from dialects import messages as m
from vehicle.telemetry.scaling import UINT32, scale_to_int
from vehicle.telemetry.view import TelemetryView

UNUSED_UINT8, UNUSED_INT8, UNUSED_INT16, UNUSED_UINT32 = 255, 127, 32767, 2**32 - 1
"""Values of unused fields (common.xml)."""
CELSIUS = (-128, UNUSED_INT8 - 1)
MEBIBYTES = (0, UNUSED_UINT32 - 1)
MEBIBYTE = 2.0**-20
"""MiB in a byte."""
UNDER_VOLTAGE, THROTTLED = 1, 2
"""COMPUTER_STATUS_FLAGS."""


def onboard_computer_status(view: TelemetryView) -> m.Message | None:
    """Build ONBOARD_COMPUTER_STATUS; None if the computer is not monitored."""
    computer = view.readings.computer
    if computer is None:
        return None
    uptime = view.since_boot if computer.uptime is None else computer.uptime
    no_link, no_storage = [UNUSED_UINT32] * 6, [UNUSED_UINT32] * 4
    # Load is a mean over all cores, sent as that of the first: cpu_combined would need ten slices of 100 ms.
    load = scale_to_int(computer.load, (0, 100), 100, unknown=UNUSED_UINT8)
    celsius = scale_to_int(computer.temperature, CELSIUS, unknown=UNUSED_INT8)
    return m.OnboardComputerStatus(
        time_usec=view.boot_us,
        uptime=scale_to_int(uptime, UINT32, 1000),
        type=0,
        cpu_cores=[load, *[UNUSED_UINT8] * 7],
        cpu_combined=[UNUSED_UINT8] * 10,
        gpu_cores=[UNUSED_UINT8] * 4,
        gpu_combined=[UNUSED_UINT8] * 10,
        temperature_board=UNUSED_INT8,
        temperature_core=[celsius, *[UNUSED_INT8] * 7],
        fan_speed=[UNUSED_INT16] * 4,
        ram_usage=scale_to_int(computer.memory_used, MEBIBYTES, MEBIBYTE, unknown=UNUSED_UINT32),
        ram_total=scale_to_int(computer.memory_total, MEBIBYTES, MEBIBYTE, unknown=UNUSED_UINT32),
        storage_type=no_storage, storage_usage=no_storage, storage_total=no_storage,
        link_type=[0] * 6,  # has no value for "unused"; the rates show it
        link_tx_rate=no_link, link_rx_rate=no_link, link_tx_max=no_link, link_rx_max=no_link,
        status_flags=(UNDER_VOLTAGE if computer.under_voltage else 0) | (THROTTLED if computer.throttled else 0),
    )  # fmt: skip
