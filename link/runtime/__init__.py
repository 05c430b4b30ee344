"""Program plumbing: command line, standard streams, journal, worker thread, event loop."""
