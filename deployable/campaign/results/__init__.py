"""Results of a campaign: bounds, figures, facts, and a summary as templates over the facts."""
