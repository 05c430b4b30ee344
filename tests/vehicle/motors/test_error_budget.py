"""How long a driver tolerates hardware that does not respond."""

from __future__ import annotations

import pytest

from vehicle.motors import MotorError
from vehicle.motors.error_budget import FAILURES_MAX, SILENCE_MAX, ErrorBudget


def test_consecutive_failures_are_an_error_and_a_response_resets() -> None:
    budget = ErrorBudget()
    for _ in range(2):
        for _ in range(FAILURES_MAX - 1):
            budget.add_failure("dead", 0.0)
        budget.reset()
    for _ in range(FAILURES_MAX - 1):
        budget.add_failure("dead", 0.0)
    with pytest.raises(MotorError, match="dead"):
        budget.add_failure("dead", 0.0)


def test_silence_is_an_error_after_its_time_only() -> None:
    budget = ErrorBudget()
    budget.check_silence("dead", 1.0)
    budget.check_silence("dead", 1.0 + SILENCE_MAX)
    with pytest.raises(MotorError, match="dead"):
        budget.check_silence("dead", 1.01 + SILENCE_MAX)
