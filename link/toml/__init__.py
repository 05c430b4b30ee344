"""TOML files of the user: read and checked, with errors that name the key, its line and the remedy."""
