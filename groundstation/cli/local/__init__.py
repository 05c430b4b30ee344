"""Verbs that run in this terminal and not in a station: screens, files and settings. One module each.

Add one: a module with `run(arguments)` here, and its row in `groundstation/cli/main.py`.
"""
