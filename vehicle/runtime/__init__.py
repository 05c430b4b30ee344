"""The daemon process: links, control loop, signals, systemd, locks and log."""
