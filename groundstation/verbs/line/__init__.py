"""The verbs on the command line of the screens: run by the station, over its own links and in its own session.

To add or change:
- a verb on the `:` line of the screens: `line` in its row of the table of verbs, a `LineRule` of `action.py`;
  a word without a vehicle: `groundstation/ui/app/local_lines.py`, `LOCAL_WORDS`.
"""
