"""What is measured: cases, points, runs, bounds, their distances, and peers on the same runs."""
