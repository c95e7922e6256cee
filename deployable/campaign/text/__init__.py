"""What is said of a campaign: numbers as people write them, and templates over its facts."""
