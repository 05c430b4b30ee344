"""What the verbs that open a screen or a station have in common: arguments, settings, mistakes as lines."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Sequence

from groundstation.cli.options import given_settings
from groundstation.cli.reserved import RESERVED
from groundstation.client import StationError
from groundstation.config.config_file import ConfigError
from groundstation.config.effective import Effective, load_config, merge
from groundstation.input.keymap import KeymapError
from link.endpoint import EndpointError
from link.runtime.command_line import CommandLineParser


class UsageError(Exception):
    """A mistake on the command line; the message is one line for the user."""


def run_local(parser: CommandLineParser, arguments: Sequence[str], perform: Callable[[argparse.Namespace], int]) -> int:
    """Parse the arguments and run `perform` with them; return the exit code."""
    options = parser.parse_args(parser.reject_empty(arguments))
    return report_mistakes(lambda: perform(options))


def load_settings(options: argparse.Namespace) -> Effective:
    """Return the settings of the config file, the environment and these options. Raises ConfigError, EndpointError."""
    return merge(load_config(options.config, os.environ, RESERVED), os.environ, given_settings(options))


def report_mistakes(run: Callable[[], int], word: str = "") -> int:
    """Return the exit code of `run`; print each mistake of the user as one line. `word`: the first argument."""
    try:
        return run()
    except ConfigError as error:
        sys.stderr.writelines(f"mavhelm: {problem}\n" for problem in error.problems)
    except (UsageError, EndpointError, KeymapError, StationError) as error:
        is_word = isinstance(error, EndpointError) and repr(word) in str(error)
        hint = _describe_word(word) if is_word else None
        sys.stderr.write(f"mavhelm: {hint or error}\n")
    return 2


def _describe_word(word: str) -> str | None:
    from groundstation.cli.verb_help import EVERY_VERB  # loads the tables of verbs
    from groundstation.verbs.mavproxy_words import describe_word

    return describe_word(word, EVERY_VERB)
