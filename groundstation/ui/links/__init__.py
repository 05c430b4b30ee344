"""The Links screen: vehicles and links."""
