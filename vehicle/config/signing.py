"""The section [signing] of rover.toml, and what it makes of each link."""

from __future__ import annotations

import msgspec

from link.protocol.signing_guard import SigningPolicy
from link.signing.role import SigningRole
from link.transport.reach import is_interface_name


class SigningSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Who may send. `mavhelm vehicle key new NAME` makes a key; docs/security.md says what each choice costs."""

    required: bool = False
    """Drop all that is not signed, on every link: who has no key cannot even watch. Needs a key."""
    allow_unsigned: bool = False
    """Let everybody in the network drive who has no key. Without it they may watch and stop only, unless they come
    from this computer, a serial port, WireGuard or an interface of `private`."""
    private: tuple[str, ...] = ()
    """Network interfaces, as `ip link` shows them, behind which nobody is who may not drive, e.g. ["tailscale0"]. An
    endpoint at an address of one needs no keys, and is bound to it. Never a mobile modem: others are behind it, too."""
    open_stops: bool = True
    """Obey a stop (disarm, emergency stop, HOLD, pause) whoever sends it. False needs `required`: then a ground station
    that has lost its key cannot stop the vehicle."""


def find_problems(settings: SigningSettings) -> list[str]:
    """Return one line for each contradiction."""
    if wrong := [name for name in settings.private if not is_interface_name(name)]:
        return [f"signing.private: {wrong[0]!r} is not a name of a network interface; write each as `ip link` shows it"]
    if settings.required and settings.allow_unsigned:
        return ["signing: required and allow_unsigned contradict each other; remove one of them"]
    if not settings.open_stops and not settings.required:
        return ["signing.open_stops: false needs required = true; add it, or remove open_stops"]
    return []


def build_policy(settings: SigningSettings, *, private: bool) -> SigningPolicy:
    """Return what a link makes of unsigned frames. `private`: nobody else can reach it (link/transport/reach.py)."""
    if settings.required:
        return SigningPolicy(unsigned=None, open_stops=settings.open_stops)
    trusted = private or settings.allow_unsigned
    return SigningPolicy(unsigned=SigningRole.SET_UP if trusted else SigningRole.WATCH, open_stops=True)
