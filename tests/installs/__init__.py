"""The lines of docs/install.md, typed without a network: `python -m tests.installs` (make installs)."""
