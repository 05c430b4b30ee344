"""Command line of the long runs; see the package."""

from __future__ import annotations

import argparse
import importlib.util
import sys
import tempfile
from pathlib import Path

CORPUS = Path(__file__).parent / "corpus"
GROWN = Path(tempfile.gettempdir()) / "mavhelm-fuzz"
"""Folder of the inputs that reach new code. They are kept, so that a later run goes on where this one ended."""


def main() -> int:
    """Run one target; end with code 1 if an input raises, which is written to the corpus."""
    if importlib.util.find_spec("atheris") is None:
        print("tests.fuzz: the package atheris is missing: pip install -e '.[test,fuzz]'", file=sys.stderr)
        return 2
    import atheris  # only here: it is in the extra `fuzz`

    with atheris.instrument_imports(include=["link", "vehicle", "groundstation", "dialects"]):
        from tests.fuzz.targets import TARGETS
    args = _parse(sorted(TARGETS))
    if args.list:
        print(*sorted(TARGETS), sep="\n")
        return 0
    kept, grown = CORPUS / args.target, args.grown / args.target
    grown.mkdir(parents=True, exist_ok=True)
    options = [f"-max_total_time={round(args.minutes * 60)}", f"-seed={args.seed}", "-max_len=2048"]
    options += [f"-rss_limit_mb={args.memory}", "-print_final_stats=1", f"-artifact_prefix={CORPUS / args.target}-"]
    folders = [str(grown), *([str(kept)] if kept.is_dir() else [])]
    atheris.Setup([sys.argv[0], *options, *folders], TARGETS[args.target])
    atheris.Fuzz()  # it ends the process
    return 0


def _parse(targets: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description="Fuzz one target, guided by coverage.")
    parser.add_argument("target", nargs="?", choices=targets, default=targets[0])
    parser.add_argument("--minutes", type=float, default=10.0, metavar="N", help="default: %(default)g")
    parser.add_argument("--seed", type=int, default=1, metavar="S", help="default: %(default)s")
    parser.add_argument("--grown", type=Path, default=GROWN, metavar="DIR", help="inputs to go on with: %(default)s")
    parser.add_argument("--memory", type=int, default=2048, metavar="MB", help="most to use; default: %(default)s")
    parser.add_argument("--list", action="store_true", help="list the targets")
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
