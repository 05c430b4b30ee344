"""User interface of the ground station, the only package that imports Textual. Reads snapshots and sends intents."""
