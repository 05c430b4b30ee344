"""Settings of the ground station: their table, the file groundstation.toml, and which value wins."""
