"""The endpoints used before: what is remembered of them, and the file in which it is saved."""
