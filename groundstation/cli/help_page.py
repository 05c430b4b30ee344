"""The page of `mavhelm --help`: what a person wants to do, on one screen of 80 columns. --help-all has every option."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable

from link.endpoint import SCHEMES

PAGE = """\
usage: mavhelm [OPTION ...] [ENDPOINT ...]  the screen: choose and drive
       mavhelm VERB ...                     one thing, without a screen
       mavhelm vehicle|bridge ...           the rover daemon, the link bridge

  mavhelm --sitl                     simulated rover: hold r to arm, i to drive
  mavhelm                            vehicles that are heard, ports, simulators
  mavhelm udpin:0.0.0.0:14550        wait for vehicles of the network
  mavhelm serial:/dev/ttyUSB0:57600  over a radio

{groups}

mavhelm VERB --help shows its options, with examples.
mavhelm --help-all  shows all options, endpoints, keys and exit codes.
"""

WIDTH = 80


class HelpPage(argparse.Action):
    """Prints the page and exits."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        """Print the page and exit."""
        sys.stdout.write(build_page())
        parser.exit()


def build_page() -> str:
    """Return the page, of lines of at most 80 characters."""
    from groundstation.cli.verb_help import group_verbs  # loads the tables of verbs

    groups = [_wrap(group, verbs) for group, verbs in group_verbs()]
    return PAGE.format(groups="\n".join([*groups, "", _wrap("endpoint", (each.syntax for each in SCHEMES.values()))]))


def _wrap(title: str, words: Iterable[str]) -> str:
    """Return a title and words behind it, indented below each other."""
    lines = [f"  {title:<9}"]
    for word in words:
        if len(lines[-1]) + 1 + len(word) > WIDTH:
            lines.append(" " * 11)
        lines[-1] += f" {word}"
    return "\n".join(lines)
