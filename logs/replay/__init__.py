"""One module alone, fed what it heard, its words compared with the log."""
