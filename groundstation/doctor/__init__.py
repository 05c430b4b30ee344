"""Doctor: why the vehicle cannot be driven, and what to do. One table for the Setup screen and for the verb."""
