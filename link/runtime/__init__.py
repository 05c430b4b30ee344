"""What all programs share: command line, standard streams, journal, TOML files, threads, event loop."""
