"""The shells that `groundstation completion` has a script for."""

SHELLS = ("bash", "zsh", "fish")
