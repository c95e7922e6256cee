"""What a campaign tells: bounds, figures, facts, and a summary by templates over these."""
