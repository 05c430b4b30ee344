"""`groundstation param`: get, set, save, load and diff the parameters of a vehicle."""

from __future__ import annotations

import argparse
import fnmatch
from collections.abc import Iterable, Sequence

from groundstation.formats.param_compare import compare
from groundstation.formats.param_file import ParamFile, format_params, parse_params
from groundstation.formats.param_form import ParamForm
from groundstation.vehicles.param_requests import param_type_name
from groundstation.vehicles.requests import RequestState
from groundstation.verbs.exit_codes import ExitCode, VerbError, code_of
from groundstation.verbs.local_file import check_new_file, read_text, write_text
from groundstation.verbs.output import Output
from groundstation.verbs.reports import finish
from groundstation.verbs.session import VerbSession
from link.services.param.client import Param
from link.services.param.float32 import same_float32, value_text

WILDCARDS = "*?["


async def get(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Print parameters by name, or all that match a pattern."""
    if options.patterns and not any(set(WILDCARDS) & set(pattern) for pattern in options.patterns):
        return await _get_named(session, [_name(each) for each in options.patterns], output)
    code = await _fetch(session, output)
    chosen = _matching(session.services.params.client.params.values(), options.patterns)
    for param in chosen:
        _print(param, output)
    if options.patterns and not chosen:
        raise VerbError(ExitCode.DIFFERS, f"no parameter matches {' or '.join(options.patterns)}")
    return code


async def set_value(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Set one parameter; done when the vehicle reports the new value."""
    await session.need_only_vehicle(options.vehicle)
    name = _name(options.name)
    report = await session.request(lambda number, now: session.services.params.set(number, name, options.value, now))
    known = session.services.params.client.params.get(name)
    if report.state is RequestState.ACCEPTED:
        output.line(f"{name} {value_text(options.value)} ({report.detail})")
    return finish(session, report, output, param_id=name, param_value=known.value if known else None)


async def save(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Write parameters to a file."""
    check_new_file(options.file, overwrite=options.yes)
    await _fetch_whole(session, output)
    params = _matching(session.services.params.client.params.values(), options.patterns)
    if options.changed:
        params = _changed(params)
    state = session.vehicle
    text = format_params(params, ParamForm(options.format), vehicle=state.system, component=state.component)
    write_text(options.file, text)
    output.note(f"{_count(len(params))} of {state.name} saved to {options.file}")
    output.result(True, state.system, file=options.file, parameters=len(params))
    return ExitCode.DONE


async def diff(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Print where a file and the vehicle differ."""
    file = _read(options.file)
    await _fetch_whole(session, output)
    differing, missing = _compare(file, session)
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
    """Set what differs from a file; stops at the first refusal."""
    file = _read(options.file)
    await session.need_only_vehicle(options.vehicle)
    await _fetch_whole(session, output)
    differing, missing = _compare(file, session)
    if missing:
        output.note(f"not on the vehicle: {', '.join(missing)}")
    if options.dry_run:
        for name, wanted, param in differing:
            output.line(f"{name:<16} {value_text(param.value)} -> {value_text(wanted)}")
            output.record(param_id=name, before=param.value, param_value=wanted)
        return ExitCode.DIFFERS if differing or missing else ExitCode.DONE
    return await _write(session, differing, missing, output)


async def store(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Have the vehicle store all parameters."""
    await session.need_only_vehicle(options.vehicle)
    return finish(
        session, await session.request(session.services.param_storage.store), output, "has stored its parameters"
    )


async def reset(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Have the vehicle reset all parameters to their defaults."""
    if not options.yes:
        raise VerbError(ExitCode.USAGE, "this resets ALL parameters of the vehicle; --yes does it")
    await session.need_only_vehicle(options.vehicle)
    return finish(
        session, await session.request(session.services.param_storage.reset), output, "has reset its parameters"
    )


async def _write(
    session: VerbSession, differing: Sequence[tuple[str, float, Param]], missing: Sequence[str], output: Output
) -> int:
    """Set one parameter after the other."""
    params, system = session.services.params, session.vehicle.system
    for done, (name, wanted, before) in enumerate(differing):
        report = await session.request(lambda number, now, n=name, v=wanted: params.set(number, n, v, now))  # type: ignore[misc]
        if report.state is not RequestState.ACCEPTED:
            left = ", ".join(each for each, _, _ in differing[done + 1 :])
            output.note(f"{done} of {len(differing)} are set" + (f"; not tried: {left}" if left else ""))
            code = finish(session, report, output, changed=done, refused=name)
            return ExitCode.PARTLY if done else code
        output.line(f"{name:<16} {value_text(before.value)} -> {value_text(wanted)}")
    output.note(f"{_count(len(differing))} set")
    output.result(not missing, system, changed=len(differing), missing=list(missing))
    return ExitCode.PARTLY if missing else ExitCode.DONE


# ---- common parts ----


async def _get_named(session: VerbSession, names: Sequence[str], output: Output) -> int:
    codes: set[int] = set()
    for name in names:
        report = await session.request(lambda number, now, n=name: session.services.params.read(number, n, now))  # type: ignore[misc]
        if report.state is RequestState.ACCEPTED:
            _print(session.services.params.client.params[name], output)
        else:
            output.error(f"{session.vehicle.name}: {report.text}")
        codes.add(code_of(report))
    return codes.pop() if len(codes) == 1 else ExitCode.PARTLY


async def _fetch(session: VerbSession, output: Output) -> int:
    """Fetch all parameters; return PARTLY if some are missing. Raises VerbError if there are none."""
    report = await session.request(session.services.params.fetch)
    if report.state is RequestState.ACCEPTED:
        return ExitCode.DONE
    text = f"{session.vehicle.name}: {report.text}"
    if not session.services.params.client.params:
        raise VerbError(code_of(report), text)
    output.error(text)
    return ExitCode.PARTLY


async def _fetch_whole(session: VerbSession, output: Output) -> None:
    """Fetch all parameters. Raises VerbError if some are missing: a part would look like the whole."""
    if await _fetch(session, output) is not ExitCode.DONE:
        raise VerbError(ExitCode.NO_ANSWER, "nothing was changed or written, because parameters are missing")


def _matching(params: Iterable[Param], patterns: Sequence[str]) -> list[Param]:
    """Return the parameters whose name matches one of the patterns, by name; without patterns all."""
    upper = [pattern.upper() for pattern in patterns] or ["*"]
    chosen = [param for param in params if any(fnmatch.fnmatchcase(param.name.upper(), each) for each in upper)]
    return sorted(chosen, key=lambda param: param.name)


def _changed(params: Sequence[Param]) -> list[Param]:
    if all(param.default is None for param in params):
        raise VerbError(ExitCode.REFUSED, "this vehicle does not report defaults: save without --changed")
    return [param for param in params if param.default is None or not same_float32(param.value, param.default)]


def _compare(file: ParamFile, session: VerbSession) -> tuple[list[tuple[str, float, Param]], list[str]]:
    """Return what differs (name, value of the file, parameter of the vehicle), and what the vehicle lacks."""
    found = compare(file, session.services.params.client.params, session.vehicle.component)
    return list(found.different), list(found.only_file)


def only_prints(options: argparse.Namespace) -> bool:
    """Return whether `load` changes nothing."""
    return bool(options.dry_run)


def _read(path: str) -> ParamFile:
    return parse_params(read_text(path), path)


def _print(param: Param, output: Output) -> None:
    default = "" if param.default is None else f"  # default {value_text(param.default)}"
    if param.default is not None and same_float32(param.value, param.default):
        default = ""
    output.line(f"{param.name:<16} {value_text(param.value)}{default}")
    output.record(
        param_id=param.name, param_value=param.value, param_type=param_type_name(param.kind), default=param.default
    )


def _name(text: str) -> str:
    """Return a name as vehicles write it: in capitals. Escaped bytes stay as they are."""
    return text if "\\x" in text else text.upper()


def _count(number: int) -> str:
    return "1 parameter" if number == 1 else f"{number} parameters"
