"""READINGS: messages of which nothing but values is read. Most of what a vehicle sends are these."""

from __future__ import annotations

from dialects import messages as m

READINGS: frozenset[type[m.Message]] = frozenset(
    (
        m.Attitude,
        m.VfrHud,
        m.LocalPositionNed,
        m.GlobalPositionInt,
        m.GpsRawInt,
        m.ServoOutputRaw,
        m.BatteryStatus,
        m.NavControllerOutput,
        m.MissionCurrent,
        m.EkfStatusReport,
        m.Vibration,
        m.RawImu,
        m.ScaledImu,
        m.AttitudeQuaternion,
    )
)
"""They answer no request and decide on nothing: a part of the station that takes other messages only need not see them.
Who adds a message looks at all that `Station._receive_exchange` calls."""
