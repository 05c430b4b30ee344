"""Options of `vehicle key` and `groundstation sign` for argparse: how a secret is shown, and how it is entered."""

from __future__ import annotations

from typing import Any

Options = dict[str, dict[str, Any]]
"""Name -> arguments of argparse."""


def _constant(dest: str, value: str, text: str) -> dict[str, Any]:
    return {"dest": dest, "action": "store_const", "const": value, "help": text}


SHOWN: Options = {
    "--words": _constant("shown_as", "words", "print the secret as 24 words"),
    "--hex": _constant("shown_as", "hex", "print the secret as 64 hex digits"),
    "--qr": _constant("shown_as", "qr", "draw the hex digits as a QR code"),
}
"""Values: link.signing.key_actions.ShownAs."""

ENTERED: Options = {
    "--words": _constant("form", "words", "type 24 words; four letters of each are enough"),
    "--passphrase": _constant("form", "passphrase", "type that of MAVProxy, Mission Planner, QGroundControl to 5.0"),
    "--qgc-passphrase": _constant("form", "qgc-passphrase", "type that of a newer QGroundControl"),
    "--hex": {"metavar": "FILE", "help": "read 64 hex digits from a file, - for standard input"},
}
"""Values: link.signing.key_input.SecretForm."""
