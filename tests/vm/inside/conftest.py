"""Tests for the virtual machine of tests/vm. Elsewhere they are not collected: they need its pins and its systemd."""

from __future__ import annotations

import os

collect_ignore_glob = [] if "MAVHELM_VM" in os.environ else ["*"]
