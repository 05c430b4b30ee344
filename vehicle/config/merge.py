"""The parameters in force at the start: defaults, a known car's, saved ones, and those of rover.toml and this run."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from vehicle.params import PARAMETERS, ParamError, Params


def merge_params(
    given: Mapping[str, float],
    *,
    kept: Mapping[str, float],
    usual: Mapping[str, float],
    pinned: Collection[str] = (),
    run: Mapping[str, float] | None = None,
) -> tuple[Params, list[str]]:
    """Merge defaults, values `usual` for this car, saved (`kept`) and `given` values; the later wins.

    `run` holds the given values that end with the program. Raises ParamError for an invalid given value. A saved value
    that does not fit is left out, and a line says why: it comes from another version of this program, or rover.toml
    has changed since, and no ground station could correct it.
    """
    Params({**usual, **given})  # raises if the given values are invalid, whatever is saved
    first = {name: value for name, value in usual.items() if name not in kept}
    params = Params({**first, **given}, pinned=pinned, usual=usual, run=run)
    left_out = []
    for name, value in kept.items():
        if name not in given:
            try:
                _check_remote(name, value)
                params.set(name, value)
            except ParamError as error:
                left_out.append(str(error))
    return params, left_out


def _check_remote(name: str, value: float) -> None:
    """Raise ParamError for a saved value that no ground station may have set."""
    limit = PARAMETERS[name].remote_high if name in PARAMETERS else None
    if limit is not None and limit < value <= PARAMETERS[name].high:
        raise ParamError(f"{name} {value:g} is above {limit:g}, which only rover.toml or --param may set")
