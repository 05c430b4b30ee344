"""Which safety parameters are not at their defaults: the driver is told at each arming."""

from __future__ import annotations

from vehicle.params import SAFETY_PARAMETERS, Params


def list_changed_safety_params(params: Params) -> list[str]:
    """Return a text for each safety parameter that differs from the default of this vehicle.

    Also for those of rover.toml and the command line: who drives may not be who wrote them.
    """
    return [
        f"{name} is {params[name]:g}, default {params.get_default(name):g}"
        for name in SAFETY_PARAMETERS
        if params[name] != params.get_default(name)
    ]
