"""Results of the mission and parameter protocols, for people."""

from __future__ import annotations

from dialects.enums import MissionResult, ParamErrorCode

_MISSION_RESULT_NAMES: dict[int, str] = {
    **{result: result.name for result in MissionResult},
    MissionResult.INVALID_X: "INVALID_PARAM5_X",
    MissionResult.INVALID_Y: "INVALID_PARAM6_Y",
    MissionResult.CANCELLED: "OPERATION_CANCELLED",
}


def mission_result_name(result: int) -> str:
    """Return the name of a `MAV_MISSION_RESULT` without its prefix; "result 99" for an unknown one."""
    return _MISSION_RESULT_NAMES.get(result, f"result {result}")


_PARAM_ERROR_TEXTS: dict[int, str] = {
    ParamErrorCode.DOES_NOT_EXIST: "no such parameter",
    ParamErrorCode.VALUE_OUT_OF_RANGE: "the value is out of range",
    ParamErrorCode.PERMISSION_DENIED: "permission denied",
    ParamErrorCode.READ_ONLY: "it is read-only",
    ParamErrorCode.TYPE_MISMATCH: "the value does not fit its type",
}


def param_error_text(error: int) -> str:
    """Return what a `MAV_PARAM_ERROR` means; "parameter error 99" for an unknown one."""
    return _PARAM_ERROR_TEXTS.get(error, f"parameter error {error}")
