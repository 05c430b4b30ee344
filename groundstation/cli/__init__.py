"""The command line of `groundstation`."""
