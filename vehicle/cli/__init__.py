"""The command line of `vehicle` and its subcommands.

To add or change:
- a subcommand or option of `vehicle`: `vehicle/cli/subcommands.py`, `SUBCOMMANDS`; `vehicle/cli/options.py`,
  `OPTIONS`.
"""
