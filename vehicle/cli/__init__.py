"""The command line of `vehicle` and its subcommands."""
