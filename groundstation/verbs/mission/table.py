"""The table of the verbs in this room.

To add a verb, write its function in a module beside this one and add its row to VERBS.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from groundstation.verbs.action import ASKS, ONLY, RUNS, USE_MAP, VerbAction
from groundstation.verbs.common.arguments import FILE, YES, finite, metres_per_second
from groundstation.verbs.common.lazy import LazyAttribute, LazyModule, lazy_call
from groundstation.verbs.verb import Example, Group, Stage, Verb

if TYPE_CHECKING:
    from groundstation.verbs.mission import go_to, mission, plan
else:
    go_to = LazyModule("mission.go_to")
    mission = LazyModule("mission.mission")
    plan = LazyModule("mission.plan")


def _plan_actions(name: str) -> dict[str, VerbAction]:
    """Return the actions of a verb about a plan. `name`: in capitals, that of its MAV_MISSION_TYPE."""
    kind = LazyAttribute("dialects.enums", f"MissionType.{name.upper()}")
    return {
        "show": VerbAction(f"print the {name}", lazy_call(plan.show, kind), watches=True, many=True, line=RUNS),
        "get": VerbAction(f"download the {name} into a file: .plan or .waypoints", lazy_call(plan.get, kind),
                          (FILE, YES), watches=True, line=USE_MAP),
        "put": VerbAction(f"upload the {name} of a file", lazy_call(plan.put, kind), (FILE,), aliases=("set",),
                          needs_session=True, many=True, line=USE_MAP),
        "check": VerbAction(f"compare the {name} of the vehicle with a file", lazy_call(mission.check, kind), (FILE,),
                            watches=True, many=True, line=USE_MAP),
        "clear": VerbAction(f"clear the {name} on the vehicle", lazy_call(plan.clear, kind), needs_session=True,
                            many=True, line=ASKS),
        **_MORE_PLAN_ACTIONS.get(name, {}),
    }  # fmt: skip


_ITEM = {"type": mission.item_number, "metavar": "N", "help": "number of the item, as `mission show` prints it"}
_MORE_PLAN_ACTIONS: dict[str, dict[str, VerbAction]] = {
    "mission": {
        "start": VerbAction("start the mission, or go on with it", mission.start, (("item", {"nargs": "?", **_ITEM}),),
                            needs_session=True, shows_neutral=True, many=True, line=ASKS),
        "pause": VerbAction("stop where the vehicle is; start goes on", mission.pause, many=True, line=RUNS),
        "jump": VerbAction("make an item the current one", mission.jump, (("item", _ITEM),), needs_session=True,
                           shows_neutral=True, many=True, line=ASKS),
    },
    "fence": {
        "on": VerbAction("enable the fence", lazy_call(mission.enable_fence, True), needs_session=True, many=True,
                         line=RUNS),
        "off": VerbAction("disable the fence", lazy_call(mission.enable_fence, False), needs_session=True, many=True,
                          line=ASKS),
    },
}  # fmt: skip
"""Plan -> its actions beside those of all plans."""


VERBS: dict[str, Verb] = {
    "goto": Verb(Group.DRIVE, (
        Example("mavhelm goto -35.36287 149.16599", "drive there by itself; degrees", Stage.ARMED),
        Example("mavhelm goto --by 10 -5", "m north and east from where it is", Stage.MOVING),
        Example("mavhelm goto wp 4", "to the place of item 4, as `mission show` counts", Stage.MOVING),
    ), {ONLY: VerbAction("drive to a place by itself; done when the heartbeat reports such a mode", go_to.go_to,
        (("latitude", {"nargs": "?", "type": go_to.latitude, "metavar": "LAT",
                        "help": "degrees; or `wp`, and the number of an item of the mission in place of LON"}),
         ("longitude", {"nargs": "?", "type": finite, "metavar": "LON", "help": "degrees"}),
         ("--by", {"nargs": 2, "type": finite, "metavar": ("NORTH", "EAST"), "help": "m from where it is"})),
        needs_session=True, shows_neutral=True, check=go_to.check_place, line=ASKS)},
       mavproxy={"guided": "goto LAT LON"}),
    "home": Verb(Group.DRIVE, (
        Example("mavhelm home", "RTL", Stage.MOVING),
    ), {ONLY: VerbAction("drive home by itself; done when the heartbeat reports RTL", go_to.home,
                              needs_session=True, shows_neutral=True, many=True, line=ASKS)}, mavproxy={"rtl": "home"}),
    "speed": Verb(Group.DRIVE, (
        Example("mavhelm speed 0.6", "m/s of modes that drive by themselves", Stage.MOVING),
    ), {ONLY: VerbAction("set the speed of modes that drive by themselves", go_to.speed,
        (("speed", {"type": metres_per_second, "metavar": "M/S"}),), needs_session=True, shows_neutral=True,
        many=True, line=RUNS)}, mavproxy={"setspeed": "speed M/S"}),
    "mission": Verb(Group.PLANS, (
        Example("mavhelm mission put patrol.plan", "upload it; the old one stays until it is accepted"),
        Example("mavhelm mission check patrol.plan", "is it the vehicle's? code 7 if not"),
        Example("mavhelm mission show", "print the mission; > marks the current item"),
        Example("mavhelm mission get saved.plan", "download it; .waypoints for Mission Planner and MAVProxy"),
        Example("mavhelm mission start", "drive it, or go on; with a number from that item", Stage.MOVING),
        Example("mavhelm mission pause", "stop where it is", Stage.MOVING),
        Example("mavhelm mission jump 2", "go on with item 2, as show prints it", Stage.MOVING),
        Example("mavhelm mission clear", "remove the mission on the vehicle", Stage.IN_CONTROL),
    ), _plan_actions("mission"), "show, get, put, check or clear the mission; start, pause or jump",
       mavproxy={"wp": "mission", "wp list": "mission show", "wp load": "mission put FILE",
                 "wp save": "mission get FILE", "wp clear": "mission clear", "wp set": "mission jump N"}),
    "fence": Verb(Group.PLANS, (
        Example("mavhelm fence put patrol.plan", "the fence of the same file; also for rally"),
        Example("mavhelm fence check patrol.plan", "as for a mission"),
        Example("mavhelm fence show", "print it"),
        Example("mavhelm fence get fence.plan", "download it"),
        Example("mavhelm fence on", "off: turn the fence off"),
        Example("mavhelm fence off", "disable it", Stage.IN_CONTROL),
        Example("mavhelm fence clear", "remove it", Stage.IN_CONTROL),
    ), _plan_actions("fence"), "show, get, put, check or clear the fence; on or off",
       mavproxy={"fence load": "fence put FILE", "fence list": "fence show", "fence save": "fence get FILE",
                 "fence enable": "fence on", "fence disable": "fence off"}),
    "rally": Verb(Group.PLANS, (
        Example("mavhelm rally put patrol.plan", "upload them"),
        Example("mavhelm rally check patrol.plan", "as for a mission"),
        Example("mavhelm rally show", "print them"),
        Example("mavhelm rally get rally.plan", "download them"),
        Example("mavhelm rally clear", "remove the rally points on the vehicle", Stage.IN_CONTROL),
    ), _plan_actions("rally"), "show, get, put, check or clear the rally points",
       mavproxy={"rally load": "rally put FILE", "rally list": "rally show", "rally save": "rally get FILE"}),
}  # fmt: skip
"""Verb -> its row."""
