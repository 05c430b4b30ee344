"""Errors of an I2C bus say what to do."""

from __future__ import annotations

import errno
import os

import pytest

from vehicle.hardware.i2c import NO_RESPONSE_ERRNOS, explain_bus_error, open_bus


def test_a_bus_that_does_not_exist_says_how_to_enable_one() -> None:
    pytest.importorskip("smbus2")
    with pytest.raises(OSError, match="no such bus") as caught:
        open_bus(9876)
    assert caught.value.errno == errno.ENOENT
    assert "raspi-config" in str(caught.value)


@pytest.mark.parametrize("number", NO_RESPONSE_ERRNOS)
def test_a_chip_that_does_not_respond_says_what_to_check(number: int) -> None:
    text = explain_bus_error(OSError(number, os.strerror(number)), 3)
    assert text.startswith(f"{os.strerror(number)}: no response; check wiring, power and address")
    assert "i2cdetect -y 3" in text


@pytest.mark.parametrize(
    ("error", "text"),
    [(OSError(errno.EBUSY, "in use"), "in use"), (OSError("no number"), "no number")],
)
def test_any_other_error_stays_as_it_is(error: OSError, text: str) -> None:
    assert explain_bus_error(error, 1) == text
