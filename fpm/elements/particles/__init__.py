"""What acts on particles, gravity to supports, and the probe that keeps what responses need."""
