"""Verbs of the command line: `mavhelm param get`, each one thing with one vehicle, without a screen.

To add or change:
- a verb, or an action of one: its function in a module of a room (`groundstation/verbs/control/` and so on) and its
  row, with its examples and MAVProxy's words for it, in `table.py` of that room; then
  `python -m groundstation.verbs.command_doc docs/commands.md`;
- a word of MAVProxy for which no verb is the answer: `groundstation/verbs/mavproxy_words.py`.
"""
