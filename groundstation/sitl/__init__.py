"""The simulated rovers, and the process that runs one."""
