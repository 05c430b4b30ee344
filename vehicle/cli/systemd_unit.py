"""The systemd unit of the daemon: restart when it ends, kill when it hangs, and stop the motors after both."""

from __future__ import annotations

import contextlib
import grp
import re
import shlex
import sys
from pathlib import Path

import msgspec

from link.runtime.command_line import USAGE_ERROR
from vehicle.cli.subcommand import SubcommandError
from vehicle.commands.reboot import RebootRequest

HARDWARE_GROUPS = ("dialout", "gpio", "i2c", "video")
"""Groups with access to serial ports, pins, I2C and the supply monitor on Raspberry Pi OS."""
HOMES = (Path("/home"), Path("/root"))
PWM = "sysfs-pwm"
USER = re.compile(r"[A-Za-z_][A-Za-z0-9_.-]*|[0-9]+")
PLAIN = re.compile(r"[A-Za-z0-9_/.:@%$+,=-]+")

TEMPLATE = """\
# Printed by `mavhelm vehicle systemd-unit`. To install it:
#   mavhelm vehicle systemd-unit --config {typed} | sudo tee /etc/systemd/system/rover.service
#   sudo systemctl daemon-reload && sudo systemctl enable --now rover
# To follow its log: journalctl -u rover -f

[Unit]
Description=MAVLink rover (mavhelm)
After=network.target
# Restart without limit: nobody can start the service of a rover outdoors, and missing hardware may appear later.
StartLimitIntervalSec=0
{power_units}
[Service]
Type=notify
ExecStart={vehicle} --config {config}
# Runs also after a crash or kill -9, in a process of its own: motor controllers keep their last value.
ExecStopPost={vehicle} safe-stop --config {config}
# Fed by completed control cycles only. SIGKILL, because a process that hangs handles no other signal.
WatchdogSec=1
WatchdogSignal=SIGKILL
Restart=always
RestartSec=0.5
# {reason}.
RestartPreventExitStatus={prevent}
TimeoutStartSec=30
# The daemon stops its motors at once; this also limits safe-stop, which loads slowly on a Pi with a busy SD card.
TimeoutStopSec=15
StateDirectory=mavhelm
UMask=0077

# Real-time priority for the control loop; the kernel reserves 5 % of the CPU time for other processes.
CPUSchedulingPolicy=fifo
CPUSchedulingPriority=20
OOMScoreAdjust=-900
MemoryMax=256M
TasksMax=64
LimitCORE=0

# User and devices.
{user}
{groups}DevicePolicy=closed
DeviceAllow=char-ttyAMA rw
DeviceAllow=char-ttyS rw
DeviceAllow=char-ttyUSB rw
DeviceAllow=char-ttyACM rw
DeviceAllow=char-gpiochip rw
DeviceAllow=char-i2c rw

# Private networks only. To allow more, add a line IPAddressAllow=... with `systemctl edit rover`.
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
"""Action of the computer -> exit code with which the daemon requests it."""

POWER_TEMPLATE = """\
# Printed by `mavhelm vehicle systemd-unit --power {word}`. To install it:
#   mavhelm vehicle systemd-unit --power {word} | sudo tee /etc/systemd/system/rover-{word}.service
#   sudo systemctl daemon-reload

[Unit]
Description=MAVLink rover: {word} on request of a ground station

[Service]
Type=oneshot
# The daemon's exit code: systemd passes it to ExecStart= only, since version 251. Other codes have no effect.
ExecStart=/bin/sh -c 'test "$$MONITOR_EXIT_STATUS" != {code} || exec /usr/bin/systemctl --no-block {word}'
"""
"""The unit for POWER, started by OnFailure= of the rover's unit: the daemon has no permission to reboot."""


class UnitOptions(msgspec.Struct, frozen=True):
    """What the unit depends on."""

    config: Path
    """Absolute path."""
    python: Path = Path(sys.executable)
    groups: tuple[str, ...] = ()
    """The existing HARDWARE_GROUPS: systemd does not start a service with an unknown group."""
    user: str | None = None
    """User of the service; None for a dynamic user."""
    driver: str = ""
    power: bool = False
    """REBOOT_ENABLE is 2: a ground station may reboot the computer and shut it down."""


def build_unit(options: UnitOptions) -> str:
    """Return the unit of the rover. Raises SubcommandError for a name that cannot stand in one."""
    for word in (str(options.config), str(options.python), options.user or ""):
        if not word.isprintable():
            raise SubcommandError(f"{word!r} has control characters, which a unit cannot hold: rename it")
    if options.user and not USER.fullmatch(options.user):
        raise SubcommandError(f"{options.user!r} is not the name of a user")
    in_home = any(_in_home(path) for path in (options.config, options.python))
    codes = (USAGE_ERROR, *POWER.values()) if options.power else (USAGE_ERROR,)
    reason = "No restart after an error in the file (2)"
    reason += " and after a request to reboot or shut down (81, 82)" if options.power else ""
    groups = f"SupplementaryGroups={' '.join(options.groups)}\n" if options.groups else ""
    pwm = options.driver == PWM
    return TEMPLATE.format(
        vehicle=f"{_quote(options.python)} -m link.program vehicle",
        config=_quote(options.config),
        typed=shlex.quote(str(options.config)),
        user=f"User={options.user}" if options.user else "DynamicUser=yes",
        groups=groups,
        power_units="OnFailure=rover-reboot.service rover-poweroff.service\n" if options.power else "",
        reason=reason,
        prevent=" ".join(str(int(code)) for code in codes),
        home=f"ProtectHome={'read-only' if in_home else 'yes'}",
        tunables=f"# {PWM} writes to /sys.\nProtectKernelTunables=no" if pwm else "ProtectKernelTunables=yes",
    )


def build_power_unit(word: str) -> str:
    """Return the unit for a key of POWER."""
    return POWER_TEMPLATE.format(word=word, code=int(POWER[word]))


def existing_groups() -> tuple[str, ...]:
    """Return the HARDWARE_GROUPS that exist on this machine."""
    known = {group.gr_name for group in grp.getgrall()}
    return tuple(name for name in HARDWARE_GROUPS if name in known)


def home_owner(config: Path, python: Path) -> str | None:
    """Return the owner of the home directory that contains the file or Python; other users have no access to it."""
    for path in (config, python):
        if _in_home(path) and path.exists():
            with contextlib.suppress(KeyError):  # a user id without a name
                return path.owner()
    return None


def _in_home(path: Path) -> bool:
    """Return whether a path or its link target is in a home: Python may be in one (pyenv, uv) for any environment."""
    return any(each.is_relative_to(home) for each in (path, path.resolve()) for home in HOMES)


def _quote(path: Path) -> str:
    """Quote a word of a command line in a unit (systemd.syntax(7), systemd.service(5)).

    % and $ are special there, and a backslash is also within single quotes, unlike in a shell.
    """
    word = str(path).replace("%", "%%").replace("$", "$$")
    if PLAIN.fullmatch(word):
        return word
    escaped = word.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
