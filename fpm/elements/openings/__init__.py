"""What acts on openings of hinges and slides: springs, dampers, stops, latches, motors."""
