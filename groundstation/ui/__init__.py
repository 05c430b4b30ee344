"""User interface of the ground station, the only package that imports Textual. Reads snapshots and sends intents.

To add or change:
- a key of one screen: `KEYS` of the screen, and its handler there.
"""
