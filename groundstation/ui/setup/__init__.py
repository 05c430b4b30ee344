"""What the Setup screen knows and shows, without widgets."""
