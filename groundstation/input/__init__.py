"""From keys to stick positions: key map, key repeat, control styles."""
