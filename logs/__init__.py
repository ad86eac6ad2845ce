"""Recording, reading and judging runs."""
