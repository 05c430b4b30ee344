"""What `mavhelm vehicle key` does: make, show, install, list, choose and revoke keys of MAVLink signing.

A vehicle that runs takes a change within a second; revoked keys end at once.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from functools import wraps
from pathlib import Path

from link.signing import key_actions
from link.signing.key_actions import WARNING, KeyActionError, ShownAs
from link.signing.key_file import FILE, KeyFileError, load_keys
from link.signing.key_input import STDIN, SecretForm, SecretInputError, read_secret
from link.signing.keys import SigningKey
from link.signing.missing_package import MissingPackageError
from link.signing.role import ROLES
from vehicle.cli.subcommand import DONE, SubcommandError
from vehicle.config.config import DEFAULT_FILE, RoverConfigError, load
from vehicle.config.effective_params import state_folder_of


def _one_line(run: Callable[[argparse.Namespace], int]) -> Callable[[argparse.Namespace], int]:
    """Turn the errors of keys and files into SubcommandError."""

    @wraps(run)
    def wrapped(options: argparse.Namespace) -> int:
        try:
            return run(options)
        except (KeyActionError, KeyFileError, SecretInputError, MissingPackageError, RoverConfigError) as error:
            raise SubcommandError(str(error)) from None

    return wrapped


@_one_line
def new(options: argparse.Namespace) -> int:
    """Make a key."""
    path = key_path(options)
    key = key_actions.make_key(path, options.name, ROLES[options.role])
    _report(f"{key} is in {path}")
    return _show(key, options.shown_as, "install it at the ground station: mavhelm sign install NAME")


@_one_line
def show(options: argparse.Namespace) -> int:
    """Print name, role and fingerprint of a key; the secret on request only."""
    key = key_actions.find_key(key_path(options), options.name)
    sys.stdout.write(f"{key}\n" if options.shown_as is None else "")
    return _show(key, options.shown_as)


@_one_line
def install(options: argparse.Namespace) -> int:
    """Add a key that was made elsewhere."""
    path = key_path(options)
    secret = read_secret(SecretForm.HEX if options.hex else SecretForm(options.form), options.hex or STDIN)
    key = key_actions.install_key(path, options.name, ROLES[options.role], secret)
    _report(f"{key} is in {path}; the ground station must show the same fingerprint")
    return DONE


@_one_line
def list_keys(options: argparse.Namespace) -> int:
    """Print all keys without their secrets."""
    path = key_path(options)
    ring = load_keys(path)
    sys.stdout.writelines(f"{line}\n" for line in key_actions.format_list(ring, roles=True))
    if not ring.keys:
        _report(f"there are no keys in {path}; `mavhelm vehicle key new NAME` makes one")
    return DONE


@_one_line
def use(options: argparse.Namespace) -> int:
    """Sign telemetry for everybody with this key."""
    _report(f"{key_actions.use_key(key_path(options), options.name)} signs telemetry from now on")
    return DONE


@_one_line
def revoke(options: argparse.Namespace) -> int:
    """Remove a key; its holder can do nothing any more."""
    path = key_path(options)
    key = key_actions.remove_key(path, options.name)
    left = len(load_keys(path).keys)
    _report(f"{key} is revoked; {left} {'key is' if left == 1 else 'keys are'} left")
    return DONE


def key_path(options: argparse.Namespace) -> Path:
    """Return the key file of the vehicle that `options` select. Raises RoverConfigError."""
    if options.state or not (options.config or Path(DEFAULT_FILE).exists()):
        return state_folder_of(options.state) / FILE
    return state_folder_of(load(options.config or DEFAULT_FILE).state) / FILE


def _show(key: SigningKey, shown_as: str | None, advice: str = "") -> int:
    if shown_as is not None:
        text = key_actions.format_secret(key, ShownAs(shown_as))
        _report(WARNING)
        sys.stdout.write(text)
    elif advice:
        _report(f"--words, --qr or --hex of `mavhelm vehicle key show {key.name}` show it; {advice}")
    return DONE


def _report(text: str) -> None:
    sys.stderr.write(f"mavhelm vehicle key: {text}\n")
    sys.stderr.flush()
