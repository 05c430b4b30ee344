"""Options of `mavhelm vehicle key` and `mavhelm sign` for argparse: how a secret is shown, and how it is entered."""

from __future__ import annotations

from typing import Any

Options = dict[str, dict[str, Any]]
"""Name -> arguments of argparse."""

_SHOWN_AS = {
    "words": "print the secret as 24 words",
    "hex": "print the secret as 64 hex digits",
    "qr": "draw the hex digits as a QR code",
}
_FORMS = {
    "words": "type 24 words; four letters of each are enough",
    "passphrase": "type that of MAVProxy, Mission Planner, QGroundControl to 5.0",
    "qgc-passphrase": "type that of a newer QGroundControl",
}

SHOWN: Options = {
    f"--{value}": {"dest": "shown_as", "action": "store_const", "const": value, "help": text}
    for value, text in _SHOWN_AS.items()
}
"""Values: link.signing.key_actions.ShownAs."""

ENTERED: Options = {
    f"--{value}": {"dest": "form", "action": "store_const", "const": value, "help": text}
    for value, text in _FORMS.items()
} | {"--hex": {"metavar": "FILE", "help": "read 64 hex digits from a file, - for standard input"}}
"""Values: link.signing.key_input.SecretForm."""
