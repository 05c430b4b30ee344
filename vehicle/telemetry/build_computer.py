"""ONBOARD_COMPUTER_STATUS: how the computer on board is, for any ground station. Builder only."""

from __future__ import annotations

from dialects import messages as m
from vehicle.telemetry.scaling import UINT32, scale_to_int
from vehicle.telemetry.view import TelemetryView

UNUSED_UINT8, UNUSED_INT8, UNUSED_INT16, UNUSED_UINT32 = 255, 127, 32767, 2**32 - 1
"""The definition's words for a field that is not used."""
CELSIUS = (-128, UNUSED_INT8 - 1)
MEBIBYTES = (0, UNUSED_UINT32 - 1)
MEBIBYTE = 2.0**-20
"""of a byte"""
UNDER_VOLTAGE, THROTTLED = 1, 2
"""COMPUTER_STATUS_FLAGS."""


def onboard_computer_status(view: TelemetryView) -> m.Message | None:
    """ONBOARD_COMPUTER_STATUS; nothing where the computer is not watched."""
    computer = view.readings.computer
    if computer is None:
        return None
    uptime = view.since_boot if computer.uptime is None else computer.uptime
    no_link, no_storage = [UNUSED_UINT32] * 6, [UNUSED_UINT32] * 4
    # Load is a mean over all processors, told as the first one's: cpu_combined would promise ten slices of 100 ms.
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
        link_type=[0] * 6,  # has no word for "not used"; the rates say it
        link_tx_rate=no_link, link_rx_rate=no_link, link_tx_max=no_link, link_rx_max=no_link,
        status_flags=(UNDER_VOLTAGE if computer.under_voltage else 0) | (THROTTLED if computer.throttled else 0),
    )  # fmt: skip
