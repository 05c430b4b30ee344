"""How many examples of hypothesis a test tries whose examples take long."""

from __future__ import annotations

from hypothesis import settings

FULL = 100
"""`max_examples` of the profile that tries all."""
LEAST = 5


def examples(full: int) -> int:
    """Return `full`, or its share where MAVHELM_EXAMPLES or the short suite asks for fewer (tests/conftest.py).

    CI draws the same ones each time; `make test-all` tries all, and draws new ones.
    """
    return min(full, max(LEAST, full * asked() // FULL))


def asked() -> int:
    """Return `max_examples` of the profile that counts."""
    profile = settings.default
    assert profile is not None
    return profile.max_examples
