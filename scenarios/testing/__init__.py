"""Deadline tests of scenarios with pytest: a marker, fixtures, assertions. See docs/testing.md."""
