"""What the vehicle sends, to whom, and how often."""
