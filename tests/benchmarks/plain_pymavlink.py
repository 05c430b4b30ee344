"""pymavlink's module for our definitions, as its generator writes it: the reference, without what build.py changes."""

from __future__ import annotations

import contextlib
import importlib.util
import io
import tempfile
from functools import cache
from pathlib import Path
from typing import Any


@cache
def plain_module() -> Any:
    """Return the module. It takes a second to make."""
    from dialects.build import generate_plain

    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
        path = generate_plain(Path(folder))
        spec = importlib.util.spec_from_file_location("plain_pymavlink_rover", path)
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    return module
