"""`bridge doctor`: listens on endpoints, and tells who is heard and where their frames would go. Sends nothing."""
