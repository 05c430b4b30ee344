"""The table of the verbs in this room.

To add a verb, write its function in a module beside this one and add its row to VERBS.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from groundstation.verbs.action import ONLY, USE_SETUP, VerbAction
from groundstation.verbs.common.arguments import YES, seconds
from groundstation.verbs.common.lazy import LazyModule
from groundstation.verbs.verb import Example, Group, Stage, Verb
from link.signing.key_options import ENTERED, SHOWN

if TYPE_CHECKING:
    from groundstation.verbs.setup import calibrate, doctor, sign, sign_setup
else:
    calibrate = LazyModule("setup.calibrate")
    doctor = LazyModule("setup.doctor")
    sign = LazyModule("setup.sign")
    sign_setup = LazyModule("setup.sign_setup")

_KEY = ("name", {"metavar": "NAME", "help": "name of the key, e.g. of the vehicle"})
_WHICH_KEY = ("name", {"metavar": "NAME", "help": "name or fingerprint of the key"})


VERBS: dict[str, Verb] = {
    "doctor": Verb(Group.VEHICLE, (
        Example("mavhelm doctor", "why the vehicle cannot be driven, and what to do"),
        Example("mavhelm doctor --report bug.txt", "the same as a file for a bug report"),
    ), {ONLY: VerbAction("print why the vehicle cannot be driven, and what to do", doctor.run,
        (("--report", {"metavar": "FILE", "help": "write a report for a bug, without keys and public addresses"}),
         YES, ("--driver", {"type": int, "default": 255, "metavar": "ID",
                             "help": "system id of the ground station that will drive (default: 255)"})),
        examines=True, watches=True, line=USE_SETUP)}),
    "calibrate": Verb(Group.VEHICLE, (
        Example("mavhelm calibrate gyro", "also level and pressure; the vehicle is at rest"),
        Example("mavhelm calibrate compass", "turn it until all compasses have a fit", Stage.OTHER_VEHICLE),
        Example("mavhelm calibrate sticks --for 5", "prints what `param load` takes", Stage.OTHER_VEHICLE),
    ), {ONLY: VerbAction("calibrate gyros, level or pressure at rest, compass or RC sticks by hand", calibrate.run,
        (("kind", {"choices": calibrate.CHOICES, "metavar": "KIND", "help": "gyro, level, pressure, compass, sticks"}),
         ("--for", {"dest": "seconds", "type": seconds, "metavar": "S", "help": "for the sticks (default: 20)"})),
        check=calibrate.check, needs_session=True, only_reads=calibrate.only_reads, line=USE_SETUP)}),
    "sign": Verb(Group.SETUP, (
        Example("mavhelm sign new rover",
                "a key for MAVLink signing; docs/keys.md pairs in a minute", Stage.KEYS),
        Example("mavhelm sign setup rover -e serial:/dev/ttyACM0:115200",
                "give it to a disarmed vehicle over a cable", Stage.KEYS),
        Example("mavhelm sign install boat --words",
                "enter a key that the vehicle shows; also --passphrase, --hex FILE", Stage.KEYS),
        Example("mavhelm sign show rover --qr",
                "the secret, for another device; without --qr the fingerprint", Stage.KEYS),
        Example("mavhelm sign list", "without the secrets; > marks the one that signs", Stage.KEYS),
        Example("mavhelm sign use rover", "sign with this one from now on", Stage.KEYS),
        Example("mavhelm sign forget rover", "remove it here; revoke it on the vehicle as well", Stage.KEYS),
    ), {
        "new": VerbAction("make a key for MAVLink signing", sign.new, (_KEY, *SHOWN.items()), offline=True),
        "show": VerbAction(
            "print name and fingerprint of a key; the secret on request only", sign.show,
            (("name", {"nargs": "?", "metavar": "NAME", "help": "name or fingerprint; not needed for the only key"}),
             *SHOWN.items()), offline=True),
        "install": VerbAction("enter a key that the vehicle has", sign.install, (_KEY, *ENTERED.items()), offline=True,
                              check=sign.check_install),
        "setup": VerbAction(
            "give a key to a disarmed vehicle over a serial or USB cable", sign_setup.run,
            (("name", {"nargs": "?", "metavar": "NAME", "help": "name of the key (default: the one that signs)"}),
             ("--unsigned", {"action": "store_true",
                             "help": "neither sign nor verify: for an autopilot that signs with a key that is lost"})),
            prepare=sign_setup.prepare, tap=sign_setup.watch_signatures, watches=True),
        "list": VerbAction("print the keys without their secrets; > marks the one that signs", sign.list_keys,
                           offline=True),
        "use": VerbAction("sign with this key from now on", sign.use, (_WHICH_KEY,), offline=True),
        "forget": VerbAction("remove a key here; the vehicle still has it", sign.forget, (_WHICH_KEY,), offline=True),
    }, "new, show, install, setup, list, use or forget: keys for MAVLink signing", mavproxy={"signing": "sign"}),
}  # fmt: skip
"""Verb -> its row."""
