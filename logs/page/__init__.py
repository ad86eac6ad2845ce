"""What the HTML page of a run is made of: its data, its script and its style."""
