"""`mavhelm sign`: the keys of this user's ground stations. `sign setup`, which needs a vehicle: sign_setup.py.

The role of a key counts at the vehicle only, so here it is neither asked for nor shown.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from link.signing import key_actions
from link.signing.key_actions import WARNING, KeyActionError, ShownAs
from link.signing.key_file import KeyFileError, load_keys, station_key_file
from link.signing.key_input import STDIN, SecretForm, SecretInputError, read_secret
from link.signing.keys import SigningKey
from link.signing.missing_package import MissingPackageError
from link.signing.role import SigningRole

ROLE = SigningRole.SET_UP
"""In the file; the vehicle decides by its own."""
T = TypeVar("T")


@contextmanager
def one_line_errors() -> Iterator[None]:
    """Turn the errors of keys and their file into VerbError."""
    try:
        yield
    except (KeyActionError, KeyFileError, SecretInputError, MissingPackageError) as error:
        raise VerbError(ExitCode.USAGE, str(error)) from None


def check_install(options: argparse.Namespace) -> None:
    """Read the secret, before any loop runs, so that Ctrl-C ends it at once. Raises VerbError."""
    form = SecretForm.HEX if options.hex else options.form and SecretForm(options.form)
    if form is None:
        raise VerbError(ExitCode.USAGE, "say what to enter: --words, --passphrase, --qgc-passphrase or --hex FILE")
    with one_line_errors():
        options.secret = read_secret(form, options.hex or STDIN)


async def new(_: None, options: argparse.Namespace, output: Output) -> int:
    """Make a key."""
    path = station_key_file()
    key = _call(lambda: key_actions.make_key(path, options.name, ROLE))
    output.note(f"key {key.name} ({key.fingerprint}) is in {path}")
    if options.shown_as is None:
        there = f"`mavhelm vehicle key install {key.name} --words`"
        hint = f"`mavhelm sign show {key.name} --words`, and on the vehicle {there}"
        output.note(f"give it to the vehicle: {hint}; or `mavhelm sign setup` over its serial or USB cable")
    return _print(key, options.shown_as, output)


async def show(_: None, options: argparse.Namespace, output: Output) -> int:
    """Print name and fingerprint of a key; the secret on request only."""
    key = _call(lambda: key_actions.find_key(station_key_file(), options.name))
    if options.shown_as is None:
        output.line(f"{key.name}  {key.fingerprint}")
    return _print(key, options.shown_as, output)


async def install(_: None, options: argparse.Namespace, output: Output) -> int:
    """Add a key that the vehicle has."""
    path = station_key_file()
    key = _call(lambda: key_actions.install_key(path, options.name, ROLE, options.secret))
    output.note(
        f"key {key.name} ({key.fingerprint}) is in {path}; `mavhelm vehicle key list` must show the same fingerprint"
    )
    return _print(key, None, output)


async def list_keys(_: None, options: argparse.Namespace, output: Output) -> int:
    """Print all keys without their secrets."""
    path = station_key_file()
    ring = _call(lambda: load_keys(path))
    for line in key_actions.format_list(ring, roles=False):
        output.line(line)
    for key in ring.keys:
        output.record(name=key.name, fingerprint=key.fingerprint, signs=key.name == ring.sign_with)
    if not ring.keys:
        output.note(f"there are no keys in {path}; `mavhelm sign new NAME` makes one")
    return ExitCode.DONE


async def use(_: None, options: argparse.Namespace, output: Output) -> int:
    """Sign with this key from now on."""
    key = _call(lambda: key_actions.use_key(station_key_file(), options.name))
    output.note(f"{key.name} ({key.fingerprint}) signs from now on")
    return _print(key, None, output)


async def forget(_: None, options: argparse.Namespace, output: Output) -> int:
    """Remove a key here; the vehicle still has it."""
    key = _call(lambda: key_actions.remove_key(station_key_file(), options.name))
    output.note(
        f"{key.name} ({key.fingerprint}) is forgotten here; "
        f"on the vehicle: `mavhelm vehicle key revoke {key.fingerprint}`"
    )
    return _print(key, None, output)


def _call(action: Callable[[], T]) -> T:
    with one_line_errors():
        return action()


def _print(key: SigningKey, shown_as: str | None, output: Output) -> int:
    """Print the secret if it was asked for; with --json name and fingerprint."""
    if shown_as is not None:
        with one_line_errors():
            text = key_actions.format_secret(key, ShownAs(shown_as))
        output.error(WARNING)
        sys.stdout.write(text)
    else:
        output.record(name=key.name, fingerprint=key.fingerprint)
    return ExitCode.DONE
