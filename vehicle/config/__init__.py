"""The configuration file rover.toml: reading, checking, schema and template."""
