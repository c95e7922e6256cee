"""What one run costs and gets wrong, by its mesh, step, inertia and lumping."""
