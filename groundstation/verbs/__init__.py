"""Verbs of the command line: `mavhelm param get`, each one thing with one vehicle, without a screen.

To add or change:
- a command without a screen: `groundstation/verbs/table.py`, `VERBS`, and its function in a module beside it; a new
  verb also in `groundstation/cli/verb_help.py`; its example: `examples.py` there, then `python -m
  groundstation.verbs.command_doc docs/commands.md`.
"""
