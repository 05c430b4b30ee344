"""Whether the operating system knows the right time, from NTP, GPS or PTP."""

from __future__ import annotations

TIMEX_SIZE = 512
"""Bytes: more than `struct timex` has on any machine (208 on 64 bits)."""
TIME_ERROR = 5
"""Return value of adjtimex(2) for a clock that is not synchronized."""


def is_synchronized() -> bool:
    """Return whether the kernel calls its clock synchronized; False where it cannot be asked.

    A computer without a battery for its clock starts with the time of its last shutdown (systemd-timesyncd,
    fake-hwclock). Only this tells that from the right time. https://man7.org/linux/man-pages/man2/adjtimex.2.html
    """
    import ctypes  # by programs with keys: it takes 3 ms

    try:
        libc = ctypes.CDLL(None)
        state: int = libc.adjtimex(ctypes.create_string_buffer(TIMEX_SIZE))  # modes 0: only reads
    except (OSError, AttributeError):
        return False
    return is_right(state)


def is_right(state: int) -> bool:
    """Return whether adjtimex(2) has returned a state of a clock that is kept right; -1 is an error."""
    return 0 <= state < TIME_ERROR
