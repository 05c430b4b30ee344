"""The table of the verbs in this room.

To add a verb, write its function in a module beside this one and add its row to VERBS.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from groundstation.verbs.action import ASKS, ONLY, RUNS, USE_SETUP, LineRule, VerbAction, held_key
from groundstation.verbs.common.arguments import LONGEST_HOLD, seconds, system_id
from groundstation.verbs.common.lazy import LazyModule
from groundstation.verbs.verb import Example, Group, Stage, Verb

if TYPE_CHECKING:
    from groundstation.verbs.control import arm, control, drive, flight, mode, motor, reboot, stops, turn
else:
    arm = LazyModule("control.arm")
    control = LazyModule("control.control")
    drive = LazyModule("control.drive")
    flight = LazyModule("control.flight")
    mode = LazyModule("control.mode")
    motor = LazyModule("control.motor")
    reboot = LazyModule("control.reboot")
    stops = LazyModule("control.stops")
    turn = LazyModule("control.turn")


VERBS: dict[str, Verb] = {
    "arm": Verb(Group.DRIVE, (
        Example("mavhelm arm --wait 20", "waits until the vehicle is ready, then arms it", Stage.ARMED),
    ), {ONLY: VerbAction("arm, once the vehicle is ready; done when the heartbeat reports it", arm.run,
                             needs_session=True, many=True, line=held_key("r"))}, mavproxy={"arm throttle": "arm"}),
    "disarm": Verb(Group.DRIVE, (
        Example("mavhelm disarm", "repeated until the heartbeat reports it; so are stop, estop", Stage.STOPPING),
        Example("mavhelm disarm --all",
                "all vehicles at once, with a table of the results; also with --group NAME", Stage.STOPPING),
    ), {ONLY: VerbAction("disarm, repeated until the heartbeat reports it", stops.disarm, finds=False,
                                own_timeout=True, many=True, stops=True, line=RUNS)}),
    "stop": Verb(Group.DRIVE, (
        Example("mavhelm stop", "to HOLD", Stage.STOPPED),
    ), {ONLY: VerbAction("change to HOLD, repeated until the heartbeat reports it", stops.stop, finds=False,
                              own_timeout=True, many=True, stops=True, line=RUNS)}, mavproxy={"hold": "stop"}),
    "estop": Verb(Group.DRIVE, (
        Example("mavhelm estop", "motors off and locked; what flies lands", Stage.STOPPING),
        Example("mavhelm estop --clear", "releases the lock", Stage.STOPPING),
    ), {ONLY: VerbAction("stop the motors and lock them, or land what flies; repeated until the vehicle reports it",
        stops.estop, (("--clear", {"action": "store_true", "help": "release the emergency stop"}),
         ("--cut", {"action": "store_true", "help": "cut the motors of what flies, too: it falls"})), own_timeout=True,
        finds=False, many=True, stops=True, line=RUNS)}),
    "control": Verb(Group.DRIVE, (
        Example("mavhelm control show", "who is in control", Stage.ARMED),
        Example("mavhelm control request", "take control, or ask the driver for it", Stage.IN_CONTROL),
        Example("mavhelm control release", "our own vehicle changes to HOLD", Stage.AFTERWARDS),
        Example("mavhelm control give 255", "release control once 255 asks for it; show, release", Stage.AFTERWARDS),
    ), {
        "show": VerbAction("print who is in control", control.show, watches=True, many=True, line=RUNS),
        "request": VerbAction(
            "take control, or ask the driver for it", control.request,
            (("--takeover", {"action": "store_true", "help": "others may take control without asking"}),),
            needs_session=True, many=True, line=RUNS),
        "release": VerbAction("release control; our own vehicle changes to HOLD", control.release, needs_session=True,
                              many=True, line=RUNS),
        "give": VerbAction(
            "release control once another ground station asks for it, within --wait", control.give,
            (("station", {"type": system_id, "metavar": "ID", "help": "its system id"}),), needs_session=True,
            line=LineRule("Y on Drive gives control to the ground station that asks for it")),
    }, "show, request, release or give control of a vehicle"),
    "drive": Verb(Group.DRIVE, (
        Example("mavhelm drive --throttle 30 --for 2", "by hand: %; then neutral. It must be armed", Stage.ARMED),
        Example("mavhelm drive --arm --script run.keys",
                "keys of a file; arms first, disarms at the end", Stage.STOPPING),
    ), {ONLY: VerbAction("drive by hand for a time, or as a script of keys says, then neutral", drive.run,
        (("--throttle", {"type": drive.percent, "metavar": "PERCENT", "help": "negative for backward"}),
         ("--steering", {"type": drive.percent, "metavar": "PERCENT", "help": "positive to the right"}),
         ("--side", {"type": drive.percent, "metavar": "PERCENT", "help": "of a copter: positive to the right"}),
         ("--climb", {"type": drive.percent, "metavar": "PERCENT", "help": "of a copter: negative for down"}),
         ("--for", {"dest": "seconds", "type": seconds, "metavar": "S", "help": f"up to {LONGEST_HOLD:g} s"}),
         ("--script", {"metavar": "FILE", "help": "lines such as '0.5 press i': s from the start, then a key"}),
         ("--speed", {"type": drive.limit, "metavar": "LIMIT", "help": "of the keys, 0.1 to 1, as for the screen"}),
         ("--arm", {"action": "store_true", "help": "arm first, and disarm at the end"}),
         ("--stay-armed", {"action": "store_true", "help": "do not disarm at the end what --arm has armed"})),
        needs_session=True, prepare=drive.prepare, guarded=lambda _: True,
        line=LineRule("the keys of the Drive screen (F1) drive"))}),
    "takeoff": Verb(Group.DRIVE, (
        Example("mavhelm takeoff 5 --arm", "a copter: arm, climb to 5 m and hover", Stage.OTHER_VEHICLE),
    ), {ONLY: VerbAction("have a copter take off to an altitude above the ground, and hover there", flight.take_off,
        (("altitude", {"type": flight.altitude, "metavar": "M", "help": "1 to 30 m above the ground"}),
         ("--arm", {"action": "store_true", "help": "arm first"})),
        needs_session=True, guarded=lambda _: True, line=held_key("T, to the altitude of the setting take_off"))}),
    "land": Verb(Group.DRIVE, (
        Example("mavhelm land", "a copter: land here; done when it reports that it lands", Stage.OTHER_VEHICLE),
    ), {ONLY: VerbAction("have a copter land where it is; repeated until the heartbeat reports it", flight.land,
                         line=LineRule("L lands, on the Drive screen (F1)"))}),
    "turn": Verb(Group.DRIVE, (
        Example("mavhelm turn 90", "on the spot, degrees to the right, then neutral. It must be armed", Stage.ARMED),
    ), {ONLY: VerbAction("turn on the spot by an angle, as the vehicle's heading reports it, then neutral", turn.run,
        (("degrees", {"type": turn.angle, "metavar": "DEGREES", "help": "positive to the right, up to 360"}),
         ("--steering", {"type": turn.rate, "default": 40.0, "metavar": "PERCENT", "help": "demand (default: 40)"})),
        needs_session=True, guarded=lambda _: True)}),
    "motor": Verb(Group.VEHICLE, (
        Example("mavhelm motor 1 12 --for 1", "turn motor 1 at 12 % for 1 s, wheels off the ground"),
    ), {ONLY: VerbAction("turn one motor of a disarmed vehicle, wheels off the ground", motor.run,
        (("number", {"type": int, "metavar": "N", "help": "its number, as on the Setup screen"}),
         ("throttle", {"type": motor.percent, "metavar": "PERCENT", "help": "up to 30, negative for backward"}),
         ("--for", {"dest": "seconds", "type": motor.duration, "default": 1.0, "metavar": "S",
                    "help": "how long, up to 2 s (default: 1)"})),
        examines=True, line=USE_SETUP)}),
    "modes": Verb(Group.DRIVE, (
        Example("mavhelm modes", "the modes of the vehicle; > marks the current one"),
    ), {ONLY: VerbAction("print the modes of the vehicle; > marks the current one", mode.list_modes,
                               watches=True, many=True, line=RUNS)}),
    "mode": Verb(Group.DRIVE, (
        Example("mavhelm mode HOLD", "done when the heartbeat reports it"),
    ), {ONLY: VerbAction("change the mode; done when the heartbeat reports it", mode.set_mode,
                              (("name", {"metavar": "MODE"}),), needs_session=True, shows_neutral=True, many=True,
                              line=LineRule(asks=mode.may_move))},
       mavproxy={"auto": "mode AUTO", "manual": "mode MANUAL", "loiter": "mode LOITER",
                 "steering": "mode STEERING"}),
    "reboot": Verb(Group.VEHICLE, (
        Example("mavhelm reboot", "the vehicle refuses while it is armed", Stage.AFTERWARDS),
    ), {ONLY: VerbAction("restart the vehicle; it refuses while it is armed", reboot.run, needs_session=True,
                                many=True, line=ASKS)}),
}  # fmt: skip
"""Verb -> its row."""
