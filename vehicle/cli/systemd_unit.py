"""The systemd unit of the daemon: restarted when it ends, killed when it hangs, and its motors stopped after both."""

from __future__ import annotations

import contextlib
import grp
import shlex
import sys
from dataclasses import dataclass
from pathlib import Path

from link.runtime.command_line import USAGE_ERROR
from vehicle.commands.reboot import RebootRequest

HARDWARE_GROUPS = ("dialout", "gpio", "i2c", "video")
"""Groups that may use serial ports, pins, I2C and the supply's monitor on Raspberry Pi OS."""
HOMES = (Path("/home"), Path("/root"))
PWM = "sysfs-pwm"

TEMPLATE = """\
# Printed by `vehicle systemd-unit`. To install it:
#   vehicle systemd-unit --config {config} | sudo tee /etc/systemd/system/rover.service
#   sudo systemctl daemon-reload && sudo systemctl enable --now rover
# Its log: journalctl -u rover -f

[Unit]
Description=MAVLink rover (mavhelm)
After=network.target
# Never give up: a rover on the road has nobody who starts it again, and what is missing may come.
StartLimitIntervalSec=0
{power_units}
[Service]
Type=notify
ExecStart={vehicle} --config {config}
# Also after a crash or kill -9, from a process of its own: motor controllers keep their last value.
ExecStopPost={vehicle} safe-stop --config {config}
# Fed by completed control cycles only. SIGKILL, because a process that hangs hears nothing else.
WatchdogSec=1
WatchdogSignal=SIGKILL
Restart=always
RestartSec=0.5
# {prevents}.
RestartPreventExitStatus={prevent}
TimeoutStartSec=30
# The daemon stops its motors at once; this also limits safe-stop, which a Pi with a busy card may be long to load.
TimeoutStopSec=15
StateDirectory=mavhelm
UMask=0077

# The control loop before everything else, but not for ever: the kernel leaves others 5 % of the time.
CPUSchedulingPolicy=fifo
CPUSchedulingPriority=20
OOMScoreAdjust=-900
MemoryMax=256M
TasksMax=64
LimitCORE=0

# Who it is, and which devices it sees.
{user}
{groups}DevicePolicy=closed
DeviceAllow=char-ttyAMA rw
DeviceAllow=char-ttyS rw
DeviceAllow=char-ttyUSB rw
DeviceAllow=char-ttyACM rw
DeviceAllow=char-gpiochip rw
DeviceAllow=char-i2c rw

# Private networks only. More is one line, IPAddressAllow=..., in `systemctl edit rover`.
IPAddressDeny=any
IPAddressAllow=localhost link-local 10.0.0.0/8 172.16.0.0/12 192.168.0.0/16 fc00::/7
RestrictAddressFamilies=AF_UNIX AF_INET AF_INET6

NoNewPrivileges=yes
CapabilityBoundingSet=
AmbientCapabilities=
ProtectSystem=strict
{home}
PrivateTmp=yes
PrivateMounts=yes
{tunables}
ProtectKernelModules=yes
ProtectKernelLogs=yes
ProtectControlGroups=yes
ProtectClock=yes
ProtectHostname=yes
ProtectProc=invisible
RestrictNamespaces=yes
RestrictRealtime=yes
RestrictSUIDSGID=yes
RemoveIPC=yes
LockPersonality=yes
MemoryDenyWriteExecute=yes
KeyringMode=private
SystemCallArchitectures=native
SystemCallFilter=@system-service
SystemCallFilter=~@privileged @resources
SystemCallErrorNumber=EPERM

[Install]
WantedBy=multi-user.target
"""

POWER: dict[str, RebootRequest] = {"reboot": RebootRequest.REBOOT, "poweroff": RebootRequest.POWER_OFF}
"""What the computer does -> the daemon's exit code that asks for it."""

POWER_TEMPLATE = """\
# Printed by `vehicle systemd-unit --power {word}`. To install it:
#   vehicle systemd-unit --power {word} | sudo tee /etc/systemd/system/rover-{word}.service
#   sudo systemctl daemon-reload

[Unit]
Description=MAVLink rover: {word}, because a ground station asked for it

[Service]
Type=oneshot
# How the rover's daemon ended: systemd tells ExecStart= alone, since version 251. After any other end nothing happens.
ExecStart=/bin/sh -c 'test "$$MONITOR_EXIT_STATUS" != {code} || exec /usr/bin/systemctl --no-block {word}'
"""
"""The daemon itself has no rights for it. Started by OnFailure= of the unit."""


@dataclass(frozen=True, slots=True)
class UnitOptions:
    """What the unit depends on beside the program."""

    config: Path
    """Absolute."""
    python: Path = Path(sys.executable)
    groups: tuple[str, ...] = ()
    """Those of HARDWARE_GROUPS that exist here: systemd starts nothing with one that does not."""
    user: str | None = None
    """Who it runs as; None for a user that exists only while it runs."""
    driver: str = ""
    power: bool = False
    """REBOOT_ENABLE is 2: a ground station may reboot the computer and shut it down."""


def build_unit(place: UnitOptions) -> str:
    """The unit."""
    in_home = any(_in_home(path) for path in (place.config, place.python))
    codes = (USAGE_ERROR, *POWER.values()) if place.power else (USAGE_ERROR,)
    prevents = "A mistake in the file waits for a person" + (", 81 and 82 ask for the computer" if place.power else "")
    groups = f"SupplementaryGroups={' '.join(place.groups)}\n" if place.groups else ""
    pwm = place.driver == PWM
    return TEMPLATE.format(
        vehicle=f"{_quote(place.python)} -m vehicle",
        config=_quote(place.config),
        user=f"User={place.user}" if place.user else "DynamicUser=yes",
        groups=groups,
        power_units="OnFailure=rover-reboot.service rover-poweroff.service\n" if place.power else "",
        prevents=prevents,
        prevent=" ".join(str(int(code)) for code in codes),
        home=f"ProtectHome={'read-only' if in_home else 'yes'}",
        tunables=f"# {PWM} writes to /sys.\nProtectKernelTunables=no" if pwm else "ProtectKernelTunables=yes",
    )


def build_power_unit(word: str) -> str:
    """The unit that does `word` of POWER."""
    return POWER_TEMPLATE.format(word=word, code=int(POWER[word]))


def existing_groups() -> tuple[str, ...]:
    """Those of HARDWARE_GROUPS that this machine has."""
    known = {group.gr_name for group in grp.getgrall()}
    return tuple(name for name in HARDWARE_GROUPS if name in known)


def home_owner(config: Path, python: Path) -> str | None:
    """Whose home it lives in: homes are closed to others, so it has to run as that user. None outside of homes."""
    for path in (config, python):
        if _in_home(path) and path.exists():
            with contextlib.suppress(KeyError):  # a number that belongs to nobody here
                return path.owner()
    return None


def _in_home(path: Path) -> bool:
    """Itself, or what it is a link to: the Python of an environment anywhere may live in a home (pyenv, uv)."""
    return any(each.is_relative_to(home) for each in (path, path.resolve()) for home in HOMES)


def _quote(path: Path) -> str:
    """A word of a command line in a unit, where % and $ mean something."""
    return shlex.quote(str(path)).replace("%", "%%").replace("$", "$$")
