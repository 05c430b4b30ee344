"""Atheris, which is in the extra `fuzz`: the targets with their branches counted, and one run of a target."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

CORPUS = Path(__file__).parent / "corpus"
GROWN = Path(tempfile.gettempdir()) / "mavhelm-fuzz"
"""Folder of the inputs that reach new code. They are kept, so that a later run goes on where this one ended."""
MEMORY = 2048
"""MB that a run may use."""
COUNTED = ["link", "vehicle", "groundstation", "dialects"]
NOT_COUNTED = ["dialects.rover"]
"""Generated, without branches but for the length of a payload; it takes minutes to instrument."""


def load_targets() -> dict[str, Callable[[bytes], None]]:
    """Import the targets with their branches counted. Raises ModuleNotFoundError without atheris."""
    import atheris  # only here: it is in the extra `fuzz`

    with atheris.instrument_imports(include=COUNTED, exclude=NOT_COUNTED):
        from tests.fuzz.targets import TARGETS
    return TARGETS


def run(target: str, minutes: float, seed: int, grown: Path = GROWN, memory: int = MEMORY) -> None:
    """Fuzz a target for some minutes, then end the process; an input that raises is written to the corpus."""
    import atheris

    from tests.fuzz.targets import TARGETS

    kept, found = CORPUS / target, grown / target
    found.mkdir(parents=True, exist_ok=True)
    options = [f"-max_total_time={round(minutes * 60)}", f"-seed={seed}", "-max_len=2048"]
    options += [f"-rss_limit_mb={memory}", "-print_final_stats=1", f"-artifact_prefix={CORPUS / target}-"]
    folders = [str(found), *([str(kept)] if kept.is_dir() else [])]
    atheris.Setup([sys.argv[0], *options, *folders], TARGETS[target])
    atheris.Fuzz()
