"""The parameter model that all screens share: changes that one of them proposes are pending on the Params screen."""

from __future__ import annotations

from platformdirs import user_state_path

from groundstation.ui.base.screen import ScreenContext
from groundstation.ui.params.favourites import Favourites
from groundstation.ui.params.model import ParamModel


def keep_params(context: ScreenContext) -> ParamModel:
    """Return the model that lives as long as the app."""
    favourites = context.keep(Favourites, user_state_path("mavhelm"))
    return context.keep(ParamModel, context.numbers, favourites)
