"""Who obeys: the rover daemon and its simulator. Runs without Textual."""
