"""Which vehicles a verb is for: one, all of them, or a group of the config file."""

from __future__ import annotations

import argparse
import os
from collections.abc import Mapping
from typing import TYPE_CHECKING

from groundstation.config.groups import EVERYBODY, NAME, SYNTAX, GroupError, VehicleGroup, parse_group
from groundstation.verbs.common.exit_codes import ExitCode, VerbError

if TYPE_CHECKING:
    from groundstation.verbs.action import VerbAction


def choose_group(verb: str, action: VerbAction, options: argparse.Namespace) -> VehicleGroup | None:
    """Return the vehicles of --all or --group; None without these options. Raises VerbError, ConfigError."""
    everybody, group = getattr(options, "all", False), getattr(options, "group", None)
    if not everybody and group is None:
        return None
    given = "--all" if everybody else "--group"
    if not action.many:
        raise VerbError(ExitCode.USAGE, f"{verb} is for one vehicle at a time{_why(verb)}; choose it with --vehicle")
    if options.vehicle is not None or (everybody and group is not None):
        raise VerbError(ExitCode.USAGE, f"{given}: choose one of --vehicle, --all and --group")
    return EVERYBODY if group is None else _find_group(group, options, os.environ)


def _why(verb: str) -> str:
    return ", because nobody steers several" if verb in ("drive", "goto", "send", "motor") else ""


def _find_group(text: str, options: argparse.Namespace, environment: Mapping[str, str]) -> VehicleGroup:
    """Return the group with this name, or what the text itself says. Raises VerbError, ConfigError."""
    try:
        if not NAME.fullmatch(text):
            return parse_group(text)
        from groundstation.config.effective import load_config
        from link.toml.errors import suggest

        file = load_config(options.config, environment, options.reserved)
        groups = {} if file is None else file.values.get("groups", {})
        if text in groups:
            return parse_group(groups[text])
    except GroupError as error:
        raise VerbError(ExitCode.USAGE, f"--group: {error}") from None
    hint = suggest(text, groups) if groups else "there is no [groups]"
    raise VerbError(ExitCode.USAGE, f"--group: no group {text!r} in the config file ({hint}), nor {SYNTAX}")
