"""The control files of the Debian package: its description, scripts, changelog and licences."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from datetime import UTC, datetime
from email.message import Message
from email.utils import format_datetime

from deb.target import DebTarget

PACKAGE, UNIT, USER = "mavhelm", "rover.service", "mavhelm"
STATE, CONFIG = "/var/lib/mavhelm", "/etc/mavhelm/rover.toml"
FOLDER = "/usr/lib/mavhelm"
MAINTAINER = "The mavhelm maintainers <mavhelm@localhost>"
"""There is no public address yet; a package needs one of this form."""
DESCRIPTION = """\
ground station for terminals and rover daemon for MAVLink
 mavhelm drives a MAVLink rover from a terminal: hold a key and it
 drives, let go and it stops. It has screens for missions, messages,
 parameters, charts, logs and files, and verbs for scripts.
 .
 vehicle is the daemon of a rover with motors at a Raspberry Pi, and its
 simulator. Its service rover.service is installed, and not enabled.
 .
 All that it needs of Python is in a folder of its own."""


def control(target: DebTarget, version: str, size: int) -> str:
    """Return the file control; `size` is in KiB."""
    python = f"python3 (>= {target.python}~), python3 (<< {target.next_python}~)"
    needs = f"libc6 (>= 2.28), libgcc-s1, libstdc++6, {python}, systemd | systemd-standalone-sysusers"
    return f"""\
Package: {PACKAGE}
Version: {version}
Architecture: {target.architecture}
Maintainer: {MAINTAINER}
Installed-Size: {size}
Depends: {needs}
Suggests: python3-lgpio, python3-numpy, tmux
Section: electronics
Priority: optional
Description: {DESCRIPTION}
"""


def conffiles() -> str:
    """Return the files that an administrator changes, and that an upgrade keeps."""
    return f"{CONFIG}\n"


def scripts() -> dict[str, str]:
    """Return the maintainer scripts by name.

    An upgrade stops the vehicle before its modules are replaced: what it loads later would not fit. It starts again
    where it ran, disarmed. Nothing starts by itself where it did not run: a laptop has no motors.
    """
    return {
        "preinst": _script(f"""\
            if [ "$1" = upgrade ] && [ -d /run/systemd/system ] && systemctl -q is-active {UNIT}; then
                mkdir -p /run/{PACKAGE} && touch /run/{PACKAGE}/start-again
                deb-systemd-invoke stop {UNIT}
            fi"""),
        "postinst": _script(f"""\
            if [ "$1" = configure ]; then
                systemd-sysusers {PACKAGE}.conf
                install -d -m 0700 -o {USER} -g {USER} {STATE}
                py3compile -p {PACKAGE} {FOLDER}
                if [ -d /run/systemd/system ]; then
                    systemctl --system daemon-reload
                    udevadm control --reload || true
                    if [ -e /run/{PACKAGE}/start-again ]; then
                        rm -f /run/{PACKAGE}/start-again
                        deb-systemd-invoke start {UNIT}
                    fi
                fi
                deb-systemd-helper update-state {UNIT} || true
            fi"""),
        "prerm": _script(f"""\
            if [ "$1" = remove ] && [ -d /run/systemd/system ]; then
                deb-systemd-invoke stop {UNIT}
            fi
            py3clean -p {PACKAGE}"""),
        "postrm": _script(f"""\
            if [ "$1" = remove ] && [ -d /run/systemd/system ]; then
                systemctl --system daemon-reload
            fi
            if [ "$1" = purge ]; then
                rm -rf {STATE} {FOLDER}
                deb-systemd-helper purge {UNIT} || true
            fi"""),
    }


def _script(body: str) -> str:
    return f"#!/bin/sh\nset -e\n{textwrap.dedent(body)}\n"


def changelog(version: str, suite: str, time: int) -> str:
    """Return the changelog of the package; `time` is in s since 1970."""
    date = format_datetime(datetime.fromtimestamp(time, UTC))
    return f"{PACKAGE} ({version}) {suite}; urgency=medium\n\n  * See changelog.gz.\n\n -- {MAINTAINER}  {date}\n"


def copyright_file(bundled: Iterable[Message]) -> str:
    """Return the licences: of mavhelm, and of each package that is unpacked with it."""
    ours = [
        "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/",
        "Upstream-Name: mavhelm",
        "",
        "Files: *",
        "Copyright: the mavhelm maintainers",
        "License: Apache-2.0",
        " On Debian systems the whole text is in /usr/share/common-licenses/Apache-2.0.",
    ]
    stanzas = ["\n".join(ours)]
    for metadata in sorted(bundled, key=lambda each: str(each["Name"]).lower()):
        name = str(metadata["Name"])
        place = f"{FOLDER}/lib/python3*/site-packages"
        stanzas.append(
            f"Files: {place}/{name.replace('-', '_')}*\n"
            f"Copyright: {author_of(metadata)}\n"
            f"License: {licence_of(metadata)}\n"
            f" As in the folder licenses beside METADATA of {name} {metadata['Version']}."
        )
    return "\n\n".join(stanzas) + "\n"


def author_of(metadata: Message) -> str:
    """Return who has written a package."""
    for field in ("Author", "Author-email", "Maintainer", "Maintainer-email"):
        if metadata[field]:
            return " ".join(str(metadata[field]).split())
    return f"the authors of {metadata['Name']}"


def licence_of(metadata: Message) -> str:
    """Return the licence of a package in one word of Debian's file format."""
    classifiers = [str(each) for each in metadata.get_all("Classifier", []) if str(each).startswith("License ::")]
    text = metadata["License-Expression"] or (metadata["License"] or "").strip().partition("\n")[0]
    if not text or len(text) > 60:
        text = classifiers[0].rpartition("::")[2] if classifiers else "unknown"
    return "-".join(str(text).replace(",", " ").replace("/", " ").split())


def unit(text: str) -> str:
    """Return a unit that `mavhelm vehicle systemd-unit` printed, without its advice to write it into /etc by hand."""
    head = f"# The rover of {CONFIG}. To start it with the computer: systemctl enable --now rover\n\n"
    return head + text[text.index("[Unit]") :]


def config(text: str) -> str:
    """Return the file that `vehicle init` writes, with the folder of the service for parameters, plans and keys."""
    commented = f'#state = "{STATE}"\n'
    if text.count(commented) != 1:
        raise ValueError(f"the template of rover.toml has no line {commented.strip()}")
    return text.replace(commented, commented[1:])
