"""Program plumbing: command line, standard streams, journal, TOML files, worker thread, event loop."""
