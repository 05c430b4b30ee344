"""Command line of `groundstation`."""
