"""What is said: the message set, its units and modes. The only package that touches pymavlink."""
