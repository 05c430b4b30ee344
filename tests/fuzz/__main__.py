"""Command line of the long runs; see the package."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from tests.extras import needing
from tests.fuzz import engine
from tests.fuzz.campaign import Campaign


def main() -> int:
    """Run one target, or all in turn; end with code 1 if an input raises, which is written to the corpus."""
    with needing("test,fuzz"):
        targets = engine.load_targets()
    args = _parse(sorted(targets))
    if args.list:
        print(*sorted(targets), sep="\n")
        return 0
    if args.target == "all":
        campaign = Campaign(sorted(targets), args.seed, args.grown, args.memory, args.report)
        campaign.run(args.minutes, args.turn)
        print(campaign.table())
        return 1 if campaign.failed else 0
    engine.run(args.target, args.minutes, args.seed, args.grown, args.memory)
    return 0


def _parse(targets: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m tests.fuzz", description="Fuzz one target, or all in turn, guided by coverage."
    )
    parser.add_argument("target", nargs="?", choices=["all", *targets], default="all")
    parser.add_argument("--minutes", type=float, default=10.0, metavar="N", help="default: %(default)g")
    parser.add_argument(
        "--turn", type=float, default=2.0, metavar="N", help="of one target of all; default: %(default)g"
    )
    parser.add_argument("--seed", type=int, default=1, metavar="S", help="default: %(default)s")
    parser.add_argument(
        "--grown", type=Path, default=engine.GROWN, metavar="DIR", help="inputs to go on with: %(default)s"
    )
    parser.add_argument(
        "--memory", type=int, default=engine.MEMORY, metavar="MB", help="most to use; default: %(default)s"
    )
    parser.add_argument("--report", type=Path, metavar="FILE", help="of all: write the figures there, as JSON")
    parser.add_argument("--list", action="store_true", help="list the targets")
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
