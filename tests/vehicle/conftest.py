"""Hypothesis takes numbers and words from all modules that are loaded: the same ones, whichever test comes first."""

import vehicle.cli.check  # noqa: F401  the one that no test imports by itself
