"""Command protocol: COMMAND_LONG, COMMAND_INT, COMMAND_ACK, COMMAND_CANCEL.

To add or change:
- a command that takes a while: return a `Job` instead of a result: `link/services/command/jobs.py`.
"""
