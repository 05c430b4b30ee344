"""The vehicle: a rover daemon and its simulator. Does not need Textual."""
