"""The animated picture of README: the real program is recorded in a terminal and drawn. `make picture`."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PICTURE = ROOT / "docs" / "drive.png"
LARGEST = 400_000
"""Bytes of PICTURE at most."""
