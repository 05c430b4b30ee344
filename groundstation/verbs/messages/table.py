"""The table of the verbs in this room.

To add a verb, write its function in a module beside this one and add its row to VERBS.
"""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from groundstation.verbs.action import ASKS, ONLY, RUNS, USE_DRIVE, USE_LINKS, USE_MESSAGES, LineRule, VerbAction
from groundstation.verbs.common.arguments import (
    FILE,
    YES,
    Argument,
    count,
    finite,
    float32,
    rate,
    rate_or_none,
    seconds,
)
from groundstation.verbs.common.lazy import LazyModule
from groundstation.verbs.verb import Example, Group, Stage, Verb

if TYPE_CHECKING:
    from groundstation.verbs.messages import command, messages, ping, record, send, status
else:
    command = LazyModule("messages.command")
    messages = LazyModule("messages.messages")
    ping = LazyModule("messages.ping")
    record = LazyModule("messages.record")
    send = LazyModule("messages.send")
    status = LazyModule("messages.status")


def _listen(default: float) -> Argument:
    return ("--for", {"dest": "seconds", "type": seconds, "default": default, "metavar": "S",
                      "help": f"how long to listen ({default:g})"})  # fmt: skip


VERBS: dict[str, Verb] = {
    "status": Verb(Group.VEHICLE, (
        Example("mavhelm status", "mode, armed, control, battery, position; --watch goes on"),
    ), {ONLY: VerbAction("print the state of the vehicle", status.status,
        (("--watch", {"action": "store_true", "help": "print a line each second"}),
         ("--changes", {"action": "store_true", "help": "with --watch: print a line for each change, and each text"}),
         ("--for", {"dest": "seconds", "type": seconds, "metavar": "S", "help": "end --watch after this time"}),
         ("--speak", {"action": argparse.BooleanOptionalAction, "help": "with --changes: say them, too"}),
         ("--bell", {"action": argparse.BooleanOptionalAction,
                     "help": "with --changes: ring for what must not be missed"})),
        watches=True, many=True, check=status.check_status, line=USE_DRIVE)},
       mavproxy={"bat": "status", "gps": "status"}),
    "vehicles": Verb(Group.VEHICLE, (
        Example("mavhelm vehicles", "all vehicles that are heard"),
    ), {ONLY: VerbAction("print the vehicles that are heard", status.vehicles, (_listen(1.3),), watches=True,
                             line=USE_LINKS)}),
    "links": Verb(Group.LINKS, (
        Example("mavhelm links", "what arrives on each link"),
    ), {ONLY: VerbAction("print what arrives on each link", status.links, (_listen(2.0),), finds=False,
                               watches=True, line=USE_LINKS)}, mavproxy={"link": "links"}),
    "messages": Verb(Group.DATA, (
        Example("mavhelm messages --for 5", "which messages arrive, and their rates"),
    ), {ONLY: VerbAction("print which messages arrive, and their rates", messages.messages,
        (("patterns", {"nargs": "*", "metavar": "PATTERN", "help": "names; * and ? match any characters"}),
         _listen(5.0)), watches=True, line=USE_MESSAGES)}),
    "watch": Verb(Group.DATA, (
        Example("mavhelm watch ATTITUDE --csv", "or --json"),
        Example("mavhelm watch VFR_HUD.groundspeed --until '>0.5' --timeout 30",
                "code 7 if it is not so within 30 s", Stage.MOVING),
    ), {ONLY: VerbAction("print each message of a kind, until a condition holds or --timeout is over", messages.watch,
        (("what", {"metavar": "MESSAGE[.FIELD]", "help": "e.g. VFR_HUD.groundspeed"}),
         ("--until", {"metavar": "EXPR", "help": "end when it holds: '>0.5' for a field, else 'field>0.5'"}),
         ("--csv", {"action": "store_true", "help": "print comma-separated values"})),
        watches=True, follows=True, check=messages.check_watch, own_timeout=True, line=USE_MESSAGES)}),
    "request": Verb(Group.DATA, (
        Example("mavhelm request HOME_POSITION", "request one message and print it"),
    ), {ONLY: VerbAction("request one message and print it", command.request,
        (("name", {"metavar": "MESSAGE"}),
         ("params", {"nargs": "*", "type": finite, "metavar": "P", "help": "parameters 2 and up, e.g. an index"})),
        watches=True, many=True, check=command.check_message, line=RUNS)},
       mavproxy={"version": "request AUTOPILOT_VERSION"}),
    "rate": Verb(Group.DATA, (
        Example("mavhelm rate ATTITUDE 10", "10 Hz on this link"),
    ), {ONLY: VerbAction("set how often a message comes on this link", command.rate,
        (("name", {"metavar": "MESSAGE"}), ("rate", {"type": rate_or_none, "metavar": "HZ", "help": "0: never"})),
        watches=True, many=True, check=command.check_message, line=RUNS)}, mavproxy={"messagerate": "rate MESSAGE HZ"}),
    "command": Verb(Group.DATA, (
        Example("mavhelm command DO_SET_HOME 1", "any MAV_CMD by its name or number"),
    ), {ONLY: VerbAction("send a MAV_CMD; done when the vehicle has accepted", command.command,
        (("name", {"metavar": "MAV_CMD_X", "help": "its name, with or without MAV_CMD_, or its number"}),
         ("params", {"nargs": "*", "type": float32, "metavar": "P", "help": "up to 7 parameters; nan is allowed"}),
         ("--int", {"action": "store_true",
                    "help": "as COMMAND_INT; 5 and 6 in degrees for a command with a position, else whole numbers"})),
        needs_session=True, shows_neutral=True, many=True, check=command.check_command, line=ASKS)},
       mavproxy={"long": "command", "command_long": "command", "servo": "command DO_SET_SERVO N US",
                 "relay": "command DO_SET_RELAY N 0|1", "arm check": "command RUN_PREARM_CHECKS"}),
    "send": Verb(Group.DATA, (
        Example("mavhelm send STATUSTEXT severity=INFO text=hello", "any message"),
    ), {ONLY: VerbAction("send a message; what is not given is 0, and what can move the vehicle needs --yes", send.run,
        (("name", {"metavar": "MESSAGE"}), ("fields", {"nargs": "*", "metavar": "FIELD=VALUE"}),
         ("--rate", {"type": rate, "metavar": "HZ", "help": "repeat it, with --for"}),
         ("--for", {"dest": "seconds", "type": seconds, "metavar": "S", "help": "how long to repeat it"}),
         ("--yes", {"action": "store_true", "help": "send what can move the vehicle"})),
        check=send.check, guarded=send.is_demand,
        line=LineRule("use `mavhelm send` in a shell, over another link of the vehicle"))}),
    "record": Verb(Group.DATA, (
        Example("mavhelm record out.tlog --for 5", "record all that is heard; without --for until Ctrl-C"),
    ), {ONLY: VerbAction("record all that is heard into a telemetry log, until Ctrl-C", record.record,
        (FILE, ("--for", {"dest": "seconds", "type": seconds, "metavar": "S", "help": "end after this time"}), YES),
        finds=False, watches=True, prepare=record.prepare, tap=record.collect, companion=record.write)}),
    "ping": Verb(Group.LINKS, (
        Example("mavhelm ping --count 5", "round trips"),
    ), {ONLY: VerbAction("measure round trips to the vehicle", ping.ping,
        (("--count", {"type": count, "default": 4, "metavar": "N", "help": "how many (4)"}),
         ("--interval", {"type": seconds, "default": 1.0, "metavar": "S", "help": "s between two (1)"})),
        watches=True, line=USE_LINKS)}, mavproxy={"time": "ping", "timesync": "ping"}),
}  # fmt: skip
"""Verb -> its row."""
