"""Control processes that move the body, ping, and say whether a feature is there."""
