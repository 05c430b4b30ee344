"""The table of the verbs in this room.

To add a verb, write its function in a module beside this one and add its row to VERBS.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from groundstation.formats.param_form import ParamForm
from groundstation.verbs.action import ASKS, ONLY, RUNS, USE_FILES, USE_PARAMS, VerbAction
from groundstation.verbs.common.arguments import FILE, YES, number
from groundstation.verbs.common.lazy import LazyModule
from groundstation.verbs.verb import Example, Group, Stage, Verb

if TYPE_CHECKING:
    from groundstation.verbs.files import export, ftp, log, param, param_files
else:
    export = LazyModule("files.export")
    ftp = LazyModule("files.ftp")
    log = LazyModule("files.log")
    param = LazyModule("files.param")
    param_files = LazyModule("files.param_files")

_PATTERNS = ("patterns", {"nargs": "*", "metavar": "PATTERN", "help": "names; * and ? match any characters"})
_REMOTE = ("remote", {"metavar": "REMOTE", "help": "path on the vehicle, e.g. /logs/00000001.tlog"})
_SURE = ("--yes", {"action": "store_true", "help": "do it: there is no undo"})
_FORMAT = ("--format", {"choices": [form.value for form in ParamForm], "default": ParamForm.MAVPROXY.value,
                        "help": "MAVProxy (default), QGroundControl or Mission Planner"})  # fmt: skip


VERBS: dict[str, Verb] = {
    "param": Verb(Group.VEHICLE, (
        Example("mavhelm param get 'FS_*'", "print parameters; patterns match any case"),
        Example("mavhelm param get FS_TIMEOUT -e udpout:192.168.1.20:14550", "of a vehicle that listens"),
        Example("mavhelm param set FS_TIMEOUT 2", "done when the vehicle reports the new value"),
        Example("mavhelm param save rover.param", "all parameters, as MAVProxy writes them"),
        Example("mavhelm param save rover.params --changed --format qgc",
                "those not at their default, for QGroundControl"),
        Example("mavhelm param diff rover.param", "where a file and the vehicle differ"),
        Example("mavhelm param load rover.param --dry-run", "what would be set"),
        Example("mavhelm param load rover.param", "set it, all but read-only values and the vehicle's id"),
        Example("mavhelm param store", "the vehicle stores all values"),
        Example("mavhelm param reset --yes", "all go back to their defaults; there is no undo"),
    ), {
        "get": VerbAction("print parameters", param.get, (_PATTERNS,), watches=True, many=True, line=RUNS),
        "set": VerbAction(
            "set one parameter", param.set_value,
            (("name", {"metavar": "NAME"}), ("value", {"metavar": "VALUE", "type": number})), needs_session=True,
            many=True, line=ASKS),
        "save": VerbAction(
            "write parameters to a file", param_files.save,
            (FILE, _PATTERNS, ("--changed", {"action": "store_true", "help": "only those not at the default"}),
             _FORMAT, YES), watches=True, line=USE_PARAMS),
        "load": VerbAction(
            "set what differs from a file, all but read-only values and the vehicle's id", param_files.load,
            (FILE, ("--dry-run", {"action": "store_true", "help": "only print what would be set"})),
            needs_session=True, many=True, only_reads=param_files.only_prints, line=USE_PARAMS),
        "diff": VerbAction("print where a file and the vehicle differ", param_files.diff, (FILE,), watches=True,
                           many=True, line=USE_PARAMS),
        "store": VerbAction("have the vehicle store all parameters", param.store, needs_session=True,
                            many=True, line=ASKS),
        "reset": VerbAction("have the vehicle reset all parameters to their defaults", param.reset,
                            (_SURE,), needs_session=True,
                            many=True, line=ASKS),
    }, "get, set, save, load, diff, store or reset parameters of a vehicle",
       mavproxy={"param fetch": "param get", "param show": "param get", "arm list": "param get ARMING_CHECK"}),
    "ftp": Verb(Group.DATA, (
        Example("mavhelm ftp ls /logs", "files, where the vehicle has MAVLink FTP"),
        Example("mavhelm ftp get /logs/00000001.tlog", "download, resume, compare the checksum"),
        Example("mavhelm ftp crc /logs/00000001.tlog", "the checksum of a file there"),
        Example("mavhelm ftp put a.lua /scripts/a.lua", "upload and compare the checksum", Stage.OTHER_VEHICLE),
        Example("mavhelm ftp rm /logs/00000001.tlog", "remove a file there", Stage.OTHER_VEHICLE),
    ), {
        "ls": VerbAction("list a folder", ftp.ls, (("path", {"nargs": "?", "default": "/", "metavar": "FOLDER"}),),
                         watches=True, line=USE_FILES),
        "get": VerbAction("download a file, resume, and compare its checksum", ftp.get,
                          (_REMOTE, ("local", {"nargs": "?", "metavar": "FILE"}), YES), watches=True, line=USE_FILES),
        "put": VerbAction("upload a file and compare its checksum", ftp.put, (("local", {"metavar": "FILE"}), _REMOTE),
                          needs_session=True, line=USE_FILES),
        "rm": VerbAction("remove a file", ftp.rm, (_REMOTE,), needs_session=True, line=USE_FILES),
        "crc": VerbAction("print the checksum of a file, or compare it with a file here", ftp.crc,
                          (_REMOTE, ("local", {"nargs": "?", "metavar": "FILE"})), watches=True, line=USE_FILES),
    }, "ls, get, put, rm or crc files on the vehicle", mavproxy={"ftp list": "ftp ls FOLDER"}),
    "log": Verb(Group.DATA, (
        Example("mavhelm log list", "the logs on the vehicle"),
        Example("mavhelm log get latest", "download the newest"),
        Example("mavhelm log erase --yes", "all logs of the vehicle; there is no undo", Stage.IN_CONTROL),
    ), {
        "list": VerbAction("print the logs on the vehicle", log.list_logs, watches=True, line=USE_FILES),
        "get": VerbAction("download a log, or resume", log.get,
                          (("log", {"metavar": "ID", "help": "number of the log, or latest"}),
                           ("file", {"nargs": "?", "metavar": "FILE"}), YES), watches=True, line=USE_FILES),
        "erase": VerbAction("have the vehicle erase all its logs", log.erase,
                            (_SURE,), needs_session=True, line=USE_FILES),
    }, "list, get or erase the logs on the vehicle", mavproxy={"log download": "log get ID"}),
    "export": Verb(Group.DATA, (
        Example("mavhelm export f.tlog --mcap out.mcap --from 0:31 --to 0:44",
                "a part of a log, for Foxglove and ROS 2; no vehicle needed", Stage.AFTERWARDS),
    ), {ONLY: VerbAction("write a telemetry log, or a part of it, for other programs; several outputs at once",
        export.run, export.ARGUMENTS, offline=True, check=export.check)}),
}  # fmt: skip
"""Verb -> its row."""
