"""The screen of the ground station. The only package that knows Textual; it reads snapshots and sends intents."""
