"""The verbs on the command line of the screens: run by the station, over its own links and in its own session.

To add or change:
- a verb on the `:` line of the screens: `groundstation/verbs/line/rules.py`, `LINE_RULES`; a word without a vehicle:
  `groundstation/ui/app/local_lines.py`, `LOCAL_WORDS`.
"""
