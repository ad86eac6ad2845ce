"""What kind of junction this is, and which feature to test next."""
