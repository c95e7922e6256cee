"""What a campaign tells: samples of all runs, bounds, figures, and a summary."""
