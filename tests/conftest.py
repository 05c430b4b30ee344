"""Stops, with one line, where a thousand tests would fail for one reason."""

from __future__ import annotations

from dialects.fingerprint import fault

if reason := fault():
    raise SystemExit(reason)  # here and not in a hook: the other conftest.py files import the dialect
