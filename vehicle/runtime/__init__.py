"""The daemon: links, control loop, signals, systemd and locks in one process."""
