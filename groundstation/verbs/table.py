"""The table of all verbs and their actions, with their arguments.

To add an action, write its function in a module beside this one and add its row. A new verb also needs its line in
groundstation/cli/verb_help.py.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from groundstation.formats.param_form import ParamForm
from groundstation.verbs.action import ONLY, VerbAction
from groundstation.verbs.common.arguments import (
    LONGEST_HOLD,
    Argument,
    count,
    finite,
    float32,
    metres_per_second,
    number,
    rate,
    rate_or_none,
    seconds,
    system_id,
)
from groundstation.verbs.common.lazy import LazyAttribute, LazyModule, lazy_call
from link.signing.key_options import ENTERED, SHOWN

if TYPE_CHECKING:
    from groundstation.verbs.control import arm, control, drive, mode, motor, reboot, stops
    from groundstation.verbs.files import export, ftp, log, param, param_files
    from groundstation.verbs.messages import command, messages, ping, record, send, status
    from groundstation.verbs.mission import go_to, mission, plan
    from groundstation.verbs.ros import ros1, ros2
    from groundstation.verbs.setup import calibrate, doctor, sign, sign_setup
else:
    arm = LazyModule("control.arm")
    calibrate = LazyModule("setup.calibrate")
    command = LazyModule("messages.command")
    control = LazyModule("control.control")
    doctor = LazyModule("setup.doctor")
    drive = LazyModule("control.drive")
    export = LazyModule("files.export")
    ftp = LazyModule("files.ftp")
    go_to = LazyModule("mission.go_to")
    log = LazyModule("files.log")
    messages = LazyModule("messages.messages")
    mission = LazyModule("mission.mission")
    mode = LazyModule("control.mode")
    motor = LazyModule("control.motor")
    param = LazyModule("files.param")
    param_files = LazyModule("files.param_files")
    ping = LazyModule("messages.ping")
    plan = LazyModule("mission.plan")
    reboot = LazyModule("control.reboot")
    record = LazyModule("messages.record")
    ros1 = LazyModule("ros.ros1")
    ros2 = LazyModule("ros.ros2")
    send = LazyModule("messages.send")
    sign = LazyModule("setup.sign")
    sign_setup = LazyModule("setup.sign_setup")
    status = LazyModule("messages.status")
    stops = LazyModule("control.stops")


_PATTERNS = ("patterns", {"nargs": "*", "metavar": "PATTERN", "help": "names; * and ? match any characters"})
_FILE = ("file", {"metavar": "FILE"})
_REMOTE = ("remote", {"metavar": "REMOTE", "help": "path on the vehicle, e.g. /logs/00000001.tlog"})
_YES = ("--yes", {"action": "store_true", "help": "overwrite the file"})
_FORMAT = ("--format", {"choices": [form.value for form in ParamForm], "default": ParamForm.MAVPROXY.value,
                        "help": "MAVProxy (default), QGroundControl or Mission Planner"})  # fmt: skip


_KEY = ("name", {"metavar": "NAME", "help": "name of the key, e.g. of the vehicle"})
_WHICH_KEY = ("name", {"metavar": "NAME", "help": "name or fingerprint of the key"})


def _listen(default: float) -> Argument:
    return ("--for", {"dest": "seconds", "type": seconds, "default": default, "metavar": "S",
                      "help": f"how long to listen ({default:g})"})  # fmt: skip


PLANS = ("mission", "fence", "rally")
"""Verbs about a plan; in capitals they are names of MAV_MISSION_TYPE."""


def _plan_actions(name: str) -> dict[str, VerbAction]:
    kind = LazyAttribute("dialects.enums", f"MissionType.{name.upper()}")
    return {
        "show": VerbAction(f"print the {name}", lazy_call(plan.show, kind), watches=True, many=True),
        "get": VerbAction(f"download the {name} into a file: .plan or .waypoints", lazy_call(plan.get, kind),
                          (_FILE, _YES), watches=True),
        "put": VerbAction(f"upload the {name} of a file", lazy_call(plan.put, kind), (_FILE,), aliases=("set",),
                          takes_part=True, many=True),
        "check": VerbAction(f"compare the {name} of the vehicle with a file", lazy_call(mission.check, kind), (_FILE,),
                            watches=True, many=True),
        "clear": VerbAction(f"clear the {name} on the vehicle", lazy_call(plan.clear, kind), takes_part=True,
                            many=True),
        **_MORE_PLAN_ACTIONS.get(name, {}),
    }  # fmt: skip


_ITEM = {"type": mission.item_number, "metavar": "N", "help": "number of the item, as `mission show` prints it"}
_MORE_PLAN_ACTIONS: dict[str, dict[str, VerbAction]] = {
    "mission": {
        "start": VerbAction("start the mission, or go on with it", mission.start, (("item", {"nargs": "?", **_ITEM}),),
                            takes_part=True, shows_neutral=True, many=True),
        "pause": VerbAction("stop where the vehicle is; start goes on", mission.pause, many=True),
        "jump": VerbAction("make an item the current one", mission.jump, (("item", _ITEM),), takes_part=True,
                           shows_neutral=True, many=True),
    },
    "fence": {
        "on": VerbAction("enable the fence", lazy_call(mission.enable_fence, True), takes_part=True, many=True),
        "off": VerbAction("disable the fence", lazy_call(mission.enable_fence, False), takes_part=True, many=True),
    },
}  # fmt: skip
"""Plan -> its actions beside those of all plans."""


VERBS: dict[str, dict[str, VerbAction]] = {
    "status": {ONLY: VerbAction(
        "print the state of the vehicle", status.status,
        (("--watch", {"action": "store_true", "help": "print a line each second"}),
         ("--changes", {"action": "store_true", "help": "with --watch: print a line for each change, and each text"}),
         ("--for", {"dest": "seconds", "type": seconds, "metavar": "S", "help": "end --watch after this time"})),
        watches=True, many=True, check=status.check_status)},
    "vehicles": {ONLY: VerbAction("print the vehicles that are heard", status.vehicles, (_listen(1.3),), watches=True)},
    "links": {ONLY: VerbAction("print what arrives on each link", status.links, (_listen(2.0),), finds=False,
                               watches=True)},
    "arm": {ONLY: VerbAction("arm, once the vehicle is ready; done when the heartbeat reports it", arm.run,
                             takes_part=True, many=True)},
    "disarm": {ONLY: VerbAction("disarm, repeated until the heartbeat reports it", stops.disarm, finds=False,
                                own_timeout=True, many=True, stops=True)},
    "stop": {ONLY: VerbAction("change to HOLD, repeated until the heartbeat reports it", stops.stop, finds=False,
                              own_timeout=True, many=True, stops=True)},
    "estop": {ONLY: VerbAction(
        "stop the motors and lock them; repeated until the vehicle reports it", stops.estop,
        (("--clear", {"action": "store_true", "help": "release the emergency stop"}),), own_timeout=True,
        finds=False, many=True, stops=True)},
    "control": {
        "show": VerbAction("print who is in control", control.show, watches=True, many=True),
        "request": VerbAction(
            "take control, or ask the driver for it", control.request,
            (("--takeover", {"action": "store_true", "help": "others may take control without asking"}),),
            takes_part=True, many=True),
        "release": VerbAction("release control; our own vehicle changes to HOLD", control.release, takes_part=True,
                              many=True),
        "give": VerbAction(
            "release control once another ground station asks for it, within --wait", control.give,
            (("station", {"type": system_id, "metavar": "ID", "help": "its system id"}),), takes_part=True),
    },
    "goto": {ONLY: VerbAction(
        "drive to a place by itself; done when the heartbeat reports such a mode", go_to.go_to,
        (("latitude", {"nargs": "?", "type": go_to.latitude, "metavar": "LAT",
                        "help": "degrees; or `wp`, and the number of an item of the mission in place of LON"}),
         ("longitude", {"nargs": "?", "type": finite, "metavar": "LON", "help": "degrees"}),
         ("--by", {"nargs": 2, "type": finite, "metavar": ("NORTH", "EAST"), "help": "m from where it is"})),
        takes_part=True, shows_neutral=True, check=go_to.check_place)},
    "home": {ONLY: VerbAction("drive home by itself; done when the heartbeat reports RTL", go_to.home,
                              takes_part=True, shows_neutral=True, many=True)},
    "speed": {ONLY: VerbAction(
        "set the speed of modes that drive by themselves", go_to.speed,
        (("speed", {"type": metres_per_second, "metavar": "M/S"}),), takes_part=True, shows_neutral=True, many=True)},
    "drive": {ONLY: VerbAction(
        "drive by hand for a time, or as a script of keys says, then neutral", drive.run,
        (("--throttle", {"type": drive.percent, "metavar": "PERCENT", "help": "negative for backward"}),
         ("--steering", {"type": drive.percent, "metavar": "PERCENT", "help": "positive to the right"}),
         ("--for", {"dest": "seconds", "type": seconds, "metavar": "S", "help": f"up to {LONGEST_HOLD:g} s"}),
         ("--script", {"metavar": "FILE", "help": "lines such as '0.5 press i': s from the start, then a key"}),
         ("--speed", {"type": drive.limit, "metavar": "LIMIT", "help": "of the keys, 0.1 to 1, as for the screen"}),
         ("--arm", {"action": "store_true", "help": "arm first, and disarm at the end"}),
         ("--stay-armed", {"action": "store_true", "help": "do not disarm at the end what --arm has armed"})),
        takes_part=True, prepare=drive.prepare, guarded=lambda _: True)},
    "messages": {ONLY: VerbAction(
        "print which messages arrive, and their rates", messages.messages,
        (("patterns", {"nargs": "*", "metavar": "PATTERN", "help": "names; * and ? match any characters"}),
         _listen(5.0)), watches=True)},
    "watch": {ONLY: VerbAction(
        "print each message of a kind, until a condition holds or --timeout is over", messages.watch,
        (("what", {"metavar": "MESSAGE[.FIELD]", "help": "e.g. VFR_HUD.groundspeed"}),
         ("--until", {"metavar": "EXPR", "help": "end when it holds: '>0.5' for a field, else 'field>0.5'"}),
         ("--csv", {"action": "store_true", "help": "print comma-separated values"})),
        watches=True, follows=True, check=messages.check_watch, own_timeout=True)},
    "send": {ONLY: VerbAction(
        "send a message; what is not given is 0, and what can move the vehicle needs --yes", send.run,
        (("name", {"metavar": "MESSAGE"}), ("fields", {"nargs": "*", "metavar": "FIELD=VALUE"}),
         ("--rate", {"type": rate, "metavar": "HZ", "help": "repeat it, with --for"}),
         ("--for", {"dest": "seconds", "type": seconds, "metavar": "S", "help": "how long to repeat it"}),
         ("--yes", {"action": "store_true", "help": "send what can move the vehicle"})),
        check=send.check, guarded=send.is_demand)},
    "record": {ONLY: VerbAction(
        "record all that is heard into a telemetry log, until Ctrl-C", record.record,
        (_FILE, ("--for", {"dest": "seconds", "type": seconds, "metavar": "S", "help": "end after this time"}), _YES),
        finds=False, watches=True, prepare=record.prepare, tap=record.collect, companion=record.write)},
    "command": {ONLY: VerbAction(
        "send a MAV_CMD; done when the vehicle has accepted", command.command,
        (("name", {"metavar": "MAV_CMD_X", "help": "its name, with or without MAV_CMD_, or its number"}),
         ("params", {"nargs": "*", "type": float32, "metavar": "P", "help": "up to 7 parameters; nan is allowed"}),
         ("--int", {"action": "store_true",
                    "help": "as COMMAND_INT; 5 and 6 in degrees for a command with a position, else whole numbers"})),
        takes_part=True, shows_neutral=True, many=True, check=command.check_command)},
    "request": {ONLY: VerbAction(
        "request one message and print it", command.request,
        (("name", {"metavar": "MESSAGE"}),
         ("params", {"nargs": "*", "type": finite, "metavar": "P", "help": "parameters 2 and up, e.g. an index"})),
        watches=True, many=True, check=command.check_message)},
    "rate": {ONLY: VerbAction(
        "set how often a message comes on this link", command.rate,
        (("name", {"metavar": "MESSAGE"}), ("rate", {"type": rate_or_none, "metavar": "HZ", "help": "0: never"})),
        watches=True, many=True, check=command.check_message)},
    "ping": {ONLY: VerbAction(
        "measure round trips to the vehicle", ping.ping,
        (("--count", {"type": count, "default": 4, "metavar": "N", "help": "how many (4)"}),
         ("--interval", {"type": seconds, "default": 1.0, "metavar": "S", "help": "s between two (1)"})),
        watches=True)},
    "param": {
        "get": VerbAction("print parameters", param.get, (_PATTERNS,), watches=True, many=True),
        "set": VerbAction(
            "set one parameter", param.set_value,
            (("name", {"metavar": "NAME"}), ("value", {"metavar": "VALUE", "type": number})), takes_part=True,
            many=True),
        "save": VerbAction(
            "write parameters to a file", param_files.save,
            (_FILE, _PATTERNS, ("--changed", {"action": "store_true", "help": "only those not at the default"}),
             _FORMAT, _YES), watches=True),
        "load": VerbAction(
            "set what differs from a file, all but read-only values and the vehicle's id", param_files.load,
            (_FILE, ("--dry-run", {"action": "store_true", "help": "only print what would be set"})),
            takes_part=True, many=True, only_reads=param_files.only_prints),
        "diff": VerbAction("print where a file and the vehicle differ", param_files.diff, (_FILE,), watches=True,
                           many=True),
        "store": VerbAction("have the vehicle store all parameters", param.store, takes_part=True,
                            many=True),
        "reset": VerbAction("have the vehicle reset all parameters to their defaults", param.reset,
                            (("--yes", {"action": "store_true", "help": "do it: there is no undo"}),), takes_part=True,
                            many=True),
    },
    **{verb: _plan_actions(verb) for verb in PLANS},
    "modes": {ONLY: VerbAction("print the modes of the vehicle; > marks the current one", mode.list_modes,
                               watches=True, many=True)},
    "mode": {ONLY: VerbAction("change the mode; done when the heartbeat reports it", mode.set_mode,
                              (("name", {"metavar": "MODE"}),), takes_part=True, shows_neutral=True, many=True)},
    "reboot": {ONLY: VerbAction("restart the vehicle; it refuses while it is armed", reboot.run, takes_part=True,
                                many=True)},
    "doctor": {ONLY: VerbAction(
        "print why the vehicle cannot be driven, and what to do", doctor.run,
        (("--report", {"metavar": "FILE", "help": "write a report for a bug, without keys and public addresses"}),
         _YES, ("--driver", {"type": int, "default": 255, "metavar": "ID",
                             "help": "system id of the ground station that will drive (default: 255)"})),
        examines=True, watches=True)},
    "motor": {ONLY: VerbAction(
        "turn one motor of a disarmed vehicle, wheels off the ground", motor.run,
        (("number", {"type": int, "metavar": "N", "help": "its number, as on the Setup screen"}),
         ("throttle", {"type": motor.percent, "metavar": "PERCENT", "help": "up to 30, negative for backward"}),
         ("--for", {"dest": "seconds", "type": motor.duration, "default": 1.0, "metavar": "S",
                    "help": "how long, up to 2 s (default: 1)"})),
        examines=True)},
    "calibrate": {ONLY: VerbAction(
        "calibrate gyros, level or pressure at rest, compass or RC sticks by hand", calibrate.run,
        (("kind", {"choices": calibrate.CHOICES, "metavar": "KIND", "help": "gyro, level, pressure, compass, sticks"}),
         ("--for", {"dest": "seconds", "type": seconds, "metavar": "S", "help": "for the sticks (default: 20)"})),
        check=calibrate.check, takes_part=True, only_reads=calibrate.only_reads,
    )},
    "ftp": {
        "ls": VerbAction("list a folder", ftp.ls, (("path", {"nargs": "?", "default": "/", "metavar": "FOLDER"}),),
                         watches=True),
        "get": VerbAction("download a file, resume, and compare its checksum", ftp.get,
                          (_REMOTE, ("local", {"nargs": "?", "metavar": "FILE"}), _YES), watches=True),
        "put": VerbAction("upload a file and compare its checksum", ftp.put, (("local", {"metavar": "FILE"}), _REMOTE),
                          takes_part=True),
        "rm": VerbAction("remove a file", ftp.rm, (_REMOTE,), takes_part=True),
        "crc": VerbAction("print the checksum of a file, or compare it with a file here", ftp.crc,
                          (_REMOTE, ("local", {"nargs": "?", "metavar": "FILE"})), watches=True),
    },
    "log": {
        "list": VerbAction("print the logs on the vehicle", log.list_logs, watches=True),
        "get": VerbAction("download a log, or resume", log.get,
                          (("log", {"metavar": "ID", "help": "number of the log, or latest"}),
                           ("file", {"nargs": "?", "metavar": "FILE"}), _YES), watches=True),
        "erase": VerbAction("have the vehicle erase all its logs", log.erase,
                            (("--yes", {"action": "store_true", "help": "do it: there is no undo"}),), takes_part=True),
    },
    "sign": {
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
    },
    "ros1": {ONLY: VerbAction(
        "be a node of ROS 1: /command and /cmd_vel drive, telemetry is published; until Ctrl-C", ros1.run,
        ros1.ARGUMENTS, takes_part=True, guarded=lambda _: True, companion=ros1.serve)},
    "ros2": {ONLY: VerbAction(
        "be a node of ROS 2 over rmw_zenoh: /cmd_vel and /command drive, telemetry is published; until Ctrl-C",
        ros2.run, ros2.ARGUMENTS, takes_part=True, prepare=ros2.prepare, guarded=lambda _: True,
        companion=ros2.serve)},
    "export": {ONLY: VerbAction(
        "write a telemetry log, or a part of it, for other programs; several outputs at once", export.run,
        export.ARGUMENTS, offline=True, check=export.check)},
}  # fmt: skip
"""Verb -> its actions."""
