"""Modules that pymavlink's generator makes of definition files, as the vehicles of users have them."""

from __future__ import annotations

import contextlib
import importlib.util
import io
from pathlib import Path
from typing import Any

from pymavlink.generator import mavgen, mavparse


def generate(xml: Path, module: Path) -> Any:
    """Generate a module and import it. Includes must lie beside the file."""
    generator: Any = mavgen
    options = generator.Opts(str(module), wire_protocol=mavparse.PROTOCOL_2_0, language="Python3", validate=False)
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        assert generator.mavgen(options, [str(xml)])
    spec = importlib.util.spec_from_file_location(module.stem, module)
    assert spec is not None
    assert spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made
