"""AUTO: which mission items are accepted, and how they are executed."""
