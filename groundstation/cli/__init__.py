"""Command line of `mavhelm`."""
