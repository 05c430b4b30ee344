"""`mavhelm param`: save, load and compare files of parameters.

Apart from the other actions, which import no formats of files: `param set` takes about as long as its imports.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from groundstation.formats.param_compare import IDENTITY, ParamComparison, compare
from groundstation.formats.param_file import ParamFile, format_params, parse_params, split_unset, unset_text
from groundstation.formats.param_form import ParamForm
from groundstation.vehicles.requests.requests import RequestState
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.files.param import count, fetch, matching
from groundstation.verbs.session.reports import finish
from groundstation.verbs.session.session import VerbSession
from link.services.param.client import Param
from link.services.param.float32 import value_text


async def save(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Write parameters to a file."""
    await session.files.check_new(options.file, overwrite=options.yes)
    await _fetch_whole(session, output)
    params = matching(session.services.params.client.params.values(), options.patterns)
    if options.changed:
        params = _changed(params)
    params, unset = split_unset(params)
    state = session.vehicle
    text = format_params(params, ParamForm(options.format), vehicle=state.system, component=state.component)
    await session.files.write_text(options.file, text)
    output.note(f"{count(len(params))} of {state.name} saved to {options.file}{unset_text(unset)}")
    output.result(not unset, state.system, file=options.file, parameters=len(params), left_out=list(unset))
    return ExitCode.PARTLY if unset else ExitCode.DONE


async def diff(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Print where a file and the vehicle differ."""
    file = await _read(session, options.file)
    await _fetch_whole(session, output)
    found = _compare(file, session)
    differing, missing = found.different, found.only_file
    for name, wanted, param in differing:
        output.line(f"{name:<16} {value_text(wanted):<12} here {value_text(param.value)}")
        output.record(param_id=name, file=wanted, vehicle=param.value)
    for name in missing:
        output.line(f"{name:<16} not on the vehicle")
        output.record(param_id=name, file=None, vehicle=None)
    if not differing and not missing:
        output.note(f"{options.file} and {session.vehicle.name} agree")
    return ExitCode.DIFFERS if differing or missing else ExitCode.DONE


async def load(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Set what differs from a file, without the vehicle's own id; a value that the vehicle keeps stops no other."""
    file = await _read(session, options.file)
    await session.need_only_vehicle(options.vehicle)
    await _fetch_whole(session, output)
    found = _compare(file, session)
    differing, missing = found.loadable, found.only_file
    if found.own:
        output.note(f"left out, as each vehicle has its own: {', '.join(found.own)}")
    if missing:
        output.note(f"not on the vehicle: {', '.join(missing)}")
    if options.dry_run:
        for name, wanted, param in differing:
            output.line(f"{name:<16} {value_text(param.value)} -> {value_text(wanted)}")
            output.record(param_id=name, before=param.value, param_value=wanted)
        return ExitCode.DIFFERS if differing or missing else ExitCode.DONE
    return await _write(session, differing, missing, output)


def only_prints(options: argparse.Namespace) -> bool:
    """Return whether `load` changes nothing."""
    return bool(options.dry_run)


async def _write(
    session: VerbSession, differing: Sequence[tuple[str, float, Param]], missing: Sequence[str], output: Output
) -> int:
    """Set one parameter after the other. Those that a set cannot carry as they are stay, and are named."""
    params, system = session.services.params, session.vehicle.system
    lost = [name for name, wanted, _ in differing if not params.client.is_carried(name, wanted)]
    if lost:
        output.note(f"left as they are, float32 does not carry all digits of the file: {', '.join(lost)}")
    differing = [each for each in differing if each[0] not in lost]
    kept: list[str] = []
    for tried, (name, wanted, before) in enumerate(differing):
        report = await session.request(lambda number, now, n=name, v=wanted: params.set(number, n, v, now))  # type: ignore[misc]
        if report.kept:
            kept.append(name)
            output.note(report.text)
            continue
        if report.state is not RequestState.ACCEPTED:
            left, done = ", ".join(each for each, _, _ in differing[tried + 1 :]), tried - len(kept)
            output.note(f"{done} of {len(differing)} are set" + (f"; not tried: {left}" if left else ""))
            code = finish(session, report, output, changed=done, refused=name)
            return ExitCode.PARTLY if done else code
        output.line(f"{name:<16} {value_text(before.value)} -> {value_text(wanted)}")
    done = len(differing) - len(kept)
    output.note(f"{count(done)} set" + (f"; kept by the vehicle: {', '.join(kept)}" if kept else ""))
    output.result(not (missing or lost or kept), system, changed=done, missing=list(missing), lost=lost, kept=kept)
    return ExitCode.PARTLY if missing or lost or kept else ExitCode.DONE


async def _fetch_whole(session: VerbSession, output: Output) -> None:
    """Fetch all parameters. Raises VerbError if some are missing: a part would look like the whole."""
    if await fetch(session, output) is not ExitCode.DONE:
        raise VerbError(ExitCode.NO_ANSWER, "nothing was changed or written, because parameters are missing")


def _changed(params: Sequence[Param]) -> list[Param]:
    if all(param.default is None for param in params):
        raise VerbError(ExitCode.REFUSED, "this vehicle does not report defaults: save without --changed")
    others = (param for param in params if param.name not in IDENTITY)
    return [param for param in others if param.default is None or param.is_changed]


def _compare(file: ParamFile, session: VerbSession) -> ParamComparison:
    return compare(file, session.services.params.client.params, session.vehicle.component)


async def _read(session: VerbSession, path: str) -> ParamFile:
    return parse_params(await session.files.read_text(path), path)
