"""`mavhelm export`: writes a telemetry log, or a part of it, for other programs. Needs no vehicle."""

from __future__ import annotations

import argparse
import asyncio
import time
from collections.abc import Sequence
from pathlib import Path

from groundstation.export.export import Export, ExportChoice, ExportOutput, ExportResult
from groundstation.export.exporter import ExportError, NothingToExportError
from groundstation.export.log_time import FORMS, LogTime, describe_offset, parse_log_time
from groundstation.export.table import FORMATS
from groundstation.export.text_files import CSV_SUFFIX
from groundstation.vehicles.requests.requests import RequestReport
from groundstation.verbs.common.arguments import Argument, system_id
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.local_file import check_new_file
from groundstation.verbs.common.output import Output

PROGRESS_PERIOD = 0.25
"""s between two records of --progress."""
NAMED_IDS = 8
"""Ids of unknown messages that are named in a line."""


def _log_time(text: str) -> LogTime:
    try:
        return parse_log_time(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


ARGUMENTS: tuple[Argument, ...] = (
    ("file", {"metavar": "FILE.tlog"}),
    *((f"--{name}", {"action": "append", "default": [], "metavar": "OUT", "help": row.help})
      for name, row in FORMATS.items()),
    ("--from", {"dest": "begin", "type": _log_time, "metavar": "T", "help": f"where to begin: {FORMS}"}),
    ("--to", {"dest": "end", "type": _log_time, "metavar": "T", "help": "where to end; the message at T is left out"}),
    ("--messages", {"nargs": "+", "default": [], "metavar": "PATTERN", "help": "only these; * and ? match any"}),
    ("--system", {"type": system_id, "metavar": "ID", "help": "only what this system has sent"}),
    ("--yes", {"action": "store_true", "help": "overwrite files"}),
    ("--progress", {"action": "store_true", "help": "with --json: print the bytes that are read, four times a second"}),
)  # fmt: skip


def check(options: argparse.Namespace) -> None:
    """Find out what to write. Raises VerbError."""
    outputs = [ExportOutput(name, path) for name in FORMATS for path in getattr(options, name)]
    if not outputs:
        raise VerbError(ExitCode.USAGE, f"name what to write: {', '.join(f'--{name} FILE' for name in FORMATS)}")
    seen = {Path(options.file).resolve(): "the log itself"}
    for output in outputs:
        place = Path(output.path).resolve()
        if place in seen:
            raise VerbError(ExitCode.USAGE, f"{output.path}: this is {seen[place]}: name another file")
        seen[place] = f"the file of --{output.format} already"
        _check_place(output, overwrite=options.yes)
    options.outputs = outputs


def _check_place(output: ExportOutput, *, overwrite: bool) -> None:
    """Raise VerbError if the output cannot be made there."""
    path = Path(output.path)
    if output.format != "csv" or output.path.lower().endswith(CSV_SUFFIX):
        check_new_file(output.path, overwrite=overwrite)
        return
    if path.exists() and not path.is_dir():
        raise VerbError(ExitCode.USAGE, f"{path}: this is a file; name a folder for tables, or one that ends in .csv")
    if path.is_dir() and any(path.iterdir()) and not overwrite:
        raise VerbError(ExitCode.USAGE, f"{path}: this folder has files; --yes overwrites those of the same name")
    if not path.absolute().parent.is_dir():
        raise VerbError(ExitCode.USAGE, f"{path}: there is no folder {path.absolute().parent}")


async def run(session: None, options: argparse.Namespace, output: Output) -> int:
    """Write the outputs, and say what is missing in them."""
    patterns = tuple(each.upper() for each in options.messages)
    export = Export(options.file, options.outputs, ExportChoice(options.begin, options.end, patterns, options.system))
    try:
        told = time.monotonic()
        for done in export.steps():
            output.progress(RequestReport(0, f"export {options.file}", done=done, total=export.size))
            if options.progress and time.monotonic() - told >= PROGRESS_PERIOD:
                told = time.monotonic()
                output.record(done=done, total=export.size)
                output.flush()
            await asyncio.sleep(0)  # a signal ends it here
    except ExportError as error:
        raise VerbError(ExitCode.USAGE, str(error)) from None
    except NothingToExportError:
        _print_losses(export.result, output)
        raise VerbError(ExitCode.DIFFERS, f"{options.file}: nothing to export{_describe_choice(options)}") from None
    except OSError as error:
        raise VerbError(ExitCode.USAGE, f"{error.filename or options.file}: {error.strerror or error}") from error
    return _report(export.result, output)


def _report(result: ExportResult, output: Output) -> int:
    for each in result.written:
        output.note(f"{each.count} {FORMATS[each.format].counts} in {each.path}")
    for empty in result.empty:
        output.error(f"{empty.path} is not written: no {FORMATS[empty.format].counts} for it")
    if result.pictures:
        output.note(f"{result.pictures} of them are pictures of the camera")
    _print_losses(result, output)
    output.result(
        result.whole,
        None,
        files=[{"format": each.format, "file": each.path, "count": each.count} for each in result.written],
        damaged_parts=result.damaged_parts,
        damaged_bytes=result.damaged_bytes,
        pictures=result.pictures,
        damaged_picture_bytes=result.damaged_pictures,
        damage=[{"offset": each.offset, "size": each.size, "seconds": each.after / 1e6} for each in result.damage],
        unknown={str(number): count for number, count in sorted(result.unknown.items())},
    )
    return ExitCode.DONE if result.whole else ExitCode.PARTLY


def _print_losses(result: ExportResult, output: Output) -> None:
    if result.damage:
        first = result.damage[0]
        parts = "1 damaged part" if result.damaged_parts == 1 else f"{result.damaged_parts} damaged parts"
        place = f"{describe_offset(first.after)} from the start, at byte {first.offset}"
        output.error(f"{parts} of the log, {result.damaged_bytes} bytes, left out; the first {place}")
    if result.damaged_pictures:
        output.error(f"{result.damaged_pictures} bytes of the recorded pictures are no whole picture, and left out")
    if result.unknown:
        count = sum(result.unknown.values())
        what = f"{count} messages of unknown ids left out ({_ids(sorted(result.unknown))})"
        output.error(f"{what}: --dialect FILE.xml names them; ardupilotmega.xml for ArduPilot")


def _ids(numbers: Sequence[int]) -> str:
    more = ", ..." if len(numbers) > NAMED_IDS else ""
    return ", ".join(map(str, numbers[:NAMED_IDS])) + more


def _describe_choice(options: argparse.Namespace) -> str:
    chosen = [
        "between these times" if options.begin or options.end else "",
        f"of {' or '.join(options.messages)}" if options.messages else "",
        f"of system {options.system}" if options.system is not None else "",
    ]
    return "".join(f" {each}" for each in chosen if each)
