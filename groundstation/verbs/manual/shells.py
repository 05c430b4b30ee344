"""The shells that `mavhelm completion` has a script for."""

SHELLS = ("bash", "zsh", "fish")
