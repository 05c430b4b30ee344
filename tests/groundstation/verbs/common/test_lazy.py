"""A verb imports its own module only, and every name of the table exists."""

from __future__ import annotations

import subprocess
import sys

import pytest

from groundstation.verbs.common.lazy import LazyAttribute, LazyModule
from groundstation.verbs.table import VERBS

NAMES = [
    value
    for verb in VERBS.values()
    for action in verb.actions.values()
    for value in (action.run, action.check, action.guarded, action.arguments)
    if isinstance(value, LazyAttribute)
]
HEAVY = ("textual", "groundstation.station.station", "groundstation.config.settings",
         "groundstation.verbs.mission.plan",
         "groundstation.ipc", "groundstation.watchdog", "groundstation.export", "groundstation.views.union",
         "groundstation.vehicles.requests.file", "groundstation.vehicles.requests.param",
         "groundstation.formats.param_file",
         "link.services.ftp", "link.services.param.server", "link.services.log",
         "link.services.mission.client", "link.services.mission.download", "link.services.mission.upload",
         "link.signing.keys")  # fmt: skip


@pytest.mark.parametrize("name", NAMES, ids=lambda name: f"{name._module.rpartition('.')[2]}.{name._name}")
def test_every_name_exists(name: LazyAttribute) -> None:
    assert name.resolve() is not None


def test_a_name_that_is_missing_is_found_out() -> None:
    with pytest.raises(AttributeError):
        LazyModule("messages.status").nothing.resolve()


def test_a_verb_loads_neither_a_screen_nor_other_verbs() -> None:
    modules = "groundstation.__main__, groundstation.verbs.main, groundstation.verbs.messages.status"
    code = f"import sys, {modules}; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert "groundstation.verbs.messages.status" in loaded
    assert [name for name in loaded if name.startswith(HEAVY)] == []


def test_the_tables_load_no_dialect_and_no_verb() -> None:
    code = "import sys, groundstation.cli.verb_help; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert "groundstation.verbs.control.table" in loaded
    assert [name for name in loaded if name.startswith((*HEAVY, "dialects", "groundstation.verbs.control.arm"))] == []
