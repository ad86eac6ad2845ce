"""Where two runs part: what was said first that differs, who said it, and what followed."""
