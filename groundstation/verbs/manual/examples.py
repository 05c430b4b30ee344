"""A command line for each verb and action, for docs/commands.md. Tests parse and run them, in this order.

After a change run `python -m groundstation.verbs.command_doc docs/commands.md`.
"""

from __future__ import annotations

EXAMPLES: tuple[tuple[str, str], ...] = (
    ("mavhelm status", "mode, armed, control, battery, position; --watch goes on"),
    ("mavhelm vehicles", "all vehicles that are heard"),
    ("mavhelm links", "what arrives on each link"),
    ("mavhelm doctor", "why the vehicle cannot be driven, and what to do"),
    ("mavhelm doctor --report bug.txt", "the same as a file for a bug report"),
    ("mavhelm messages --for 5", "which messages arrive, and their rates"),
    ("mavhelm watch ATTITUDE --csv", "or --json"),
    ("mavhelm request HOME_POSITION", "request one message and print it"),
    ("mavhelm rate ATTITUDE 10", "10 Hz on this link"),
    ("mavhelm command DO_SET_HOME 1", "any MAV_CMD by its name or number"),
    ("mavhelm ping --count 5", "round trips"),
    ("mavhelm send STATUSTEXT severity=INFO text=hello", "any message"),
    ("mavhelm record out.tlog --for 5", "record all that is heard; without --for until Ctrl-C"),
    ("mavhelm param get 'FS_*'", "print parameters; patterns match any case"),
    ("mavhelm param get FS_TIMEOUT -e udpout:192.168.1.20:14550", "of a vehicle that listens"),
    ("mavhelm param set FS_TIMEOUT 2", "done when the vehicle reports the new value"),
    ("mavhelm param save rover.param", "all parameters, as MAVProxy writes them"),
    ("mavhelm param save rover.params --changed --format qgc", "those not at their default, for QGroundControl"),
    ("mavhelm param diff rover.param", "where a file and the vehicle differ"),
    ("mavhelm param load rover.param --dry-run", "what would be set"),
    ("mavhelm param load rover.param", "set it, all but read-only values and the vehicle's id"),
    ("mavhelm param store", "the vehicle stores all values"),
    ("mavhelm param reset --yes", "all go back to their defaults; there is no undo"),
    ("mavhelm modes", "the modes of the vehicle; > marks the current one"),
    ("mavhelm mode HOLD", "done when the heartbeat reports it"),
    ("mavhelm mission put patrol.plan", "upload it; the old one stays until it is accepted"),
    ("mavhelm mission check patrol.plan", "is it the vehicle's? code 7 if not"),
    ("mavhelm mission show", "print the mission; > marks the current item"),
    ("mavhelm mission get saved.plan", "download it; .waypoints for Mission Planner and MAVProxy"),
    ("mavhelm fence put patrol.plan", "the fence of the same file; also for rally"),
    ("mavhelm fence check patrol.plan", "as for a mission"),
    ("mavhelm fence show", "print it"),
    ("mavhelm fence get fence.plan", "download it"),
    ("mavhelm fence on", "off: turn the fence off"),
    ("mavhelm rally put patrol.plan", "upload them"),
    ("mavhelm rally check patrol.plan", "as for a mission"),
    ("mavhelm rally show", "print them"),
    ("mavhelm rally get rally.plan", "download them"),
    ("mavhelm motor 1 12 --for 1", "turn motor 1 at 12 % for 1 s, wheels off the ground"),
    ("mavhelm calibrate gyro", "also level and pressure; the vehicle is at rest"),
    ("mavhelm arm --wait 20", "waits until the vehicle is ready, then arms it"),
    ("mavhelm control show", "who is in control"),
    ("mavhelm drive --throttle 30 --for 2", "by hand: %; then neutral. It must be armed"),
    ("mavhelm goto -35.36287 149.16599", "drive there by itself; degrees"),
    ("mavhelm watch VFR_HUD.groundspeed --until '>0.5' --timeout 30", "code 7 if it is not so within 30 s"),
    ("mavhelm speed 0.6", "m/s of modes that drive by themselves"),
    ("mavhelm goto --by 10 -5", "m north and east from where it is"),
    ("mavhelm goto wp 4", "to the place of item 4, as `mission show` counts"),
    ("mavhelm mission start", "drive it, or go on; with a number from that item"),
    ("mavhelm mission pause", "stop where it is"),
    ("mavhelm mission jump 2", "go on with item 2, as show prints it"),
    ("mavhelm home", "RTL"),
    ("mavhelm stop", "to HOLD"),
    ("mavhelm ros1 --arm", "a node of ROS 1: /command and /cmd_vel drive; docs/ros.md"),
    ("mavhelm ros2 --arm --max-speed 0.5", "a node of ROS 2: /cmd_vel drives; docs/ros.md"),
    ("mavhelm disarm", "repeated until the heartbeat reports it; so are stop, estop"),
    ("mavhelm disarm --all", "all vehicles at once, with a table of the results; also with --group NAME"),
    ("mavhelm drive --arm --script run.keys", "keys of a file; arms first, disarms at the end"),
    ("mavhelm estop", "motors off and locked"),
    ("mavhelm estop --clear", "releases the lock"),
    ("mavhelm log list", "the logs on the vehicle"),
    ("mavhelm log get latest", "download the newest"),
    ("mavhelm ftp ls /logs", "files, where the vehicle has MAVLink FTP"),
    ("mavhelm ftp get /logs/00000001.tlog", "download, resume, compare the checksum"),
    ("mavhelm ftp crc /logs/00000001.tlog", "the checksum of a file there"),
    ("mavhelm control request", "take control, or ask the driver for it"),
    ("mavhelm log erase --yes", "all logs of the vehicle; there is no undo"),
    ("mavhelm mission clear", "remove the mission on the vehicle"),
    ("mavhelm fence off", "disable it"),
    ("mavhelm fence clear", "remove it"),
    ("mavhelm rally clear", "remove the rally points on the vehicle"),
    ("mavhelm control release", "our own vehicle changes to HOLD"),
    ("mavhelm control give 255", "release control once 255 asks for it; show, release"),
    ("mavhelm reboot", "the vehicle refuses while it is armed"),
    (
        "mavhelm export f.tlog --mcap out.mcap --from 0:31 --to 0:44",
        "a part of a log, for Foxglove and ROS 2; no vehicle needed",
    ),
    ("mavhelm sign new rover", "a key for MAVLink signing; docs/keys.md pairs in a minute"),
    ("mavhelm sign setup rover -e serial:/dev/ttyACM0:115200", "give it to a disarmed vehicle over a cable"),
    ("mavhelm sign install boat --words", "enter a key that the vehicle shows; also --passphrase, --hex FILE"),
    ("mavhelm sign show rover --qr", "the secret, for another device; without --qr the fingerprint"),
    ("mavhelm sign list", "without the secrets; > marks the one that signs"),
    ("mavhelm sign use rover", "sign with this one from now on"),
    ("mavhelm sign forget rover", "remove it here; revoke it on the vehicle as well"),
    ("mavhelm keys", "what this terminal sends for each key; q ends it"),
    ('eval "$(mavhelm completion bash)"', "complete verbs, options and names; also zsh, fish"),
)
"""Command line and what it does, in an order in which the simulated rover does them all."""

AUTOPILOT_EXAMPLES: tuple[tuple[str, str], ...] = (
    ("mavhelm calibrate compass", "turn it until all compasses have a fit"),
    ("mavhelm calibrate sticks --for 5", "prints what `param load` takes"),
    ("mavhelm ftp put a.lua /scripts/a.lua", "upload and compare the checksum"),
    ("mavhelm ftp rm /logs/00000001.tlog", "remove a file there"),
)
"""The same for what our own vehicle does not have."""

LOCAL_EXAMPLES: tuple[tuple[str, str], ...] = (
    ("mavhelm config init", "write a file with all settings as comments"),
    ("mavhelm config show", "what holds, and where it comes from"),
    ("mavhelm attach", "the screen again, after SSH has dropped"),
    ("mavhelm serve --headless udpin:0.0.0.0:14550", "a station for verbs and `attach`"),
    ("mavhelm serve --web", "the screens in a browser of this machine"),
    ("mavhelm replay flight.tlog", "a telemetry log in the screens"),
    ("mavhelm keys", "q ends it"),
    ("mavhelm completion fish | source", "until the shell ends"),
)
"""The same for verbs without a vehicle."""


def help_examples(verb: str, action: str = "") -> str:
    """Return the examples of a verb, or of one of its actions, as lines for --help."""
    begin = f"mavhelm {verb} {action}".split()
    rows = [row for row in (*EXAMPLES, *AUTOPILOT_EXAMPLES, *LOCAL_EXAMPLES) if row[0].split()[: len(begin)] == begin]
    width = max((len(command) for command, _ in rows if len(command) < 50), default=0)
    return "\n".join(["examples:", *(f"  {command:<{width}}  {text}" for command, text in rows)])
