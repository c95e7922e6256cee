"""K_F, the spring stiffness that the paper leaves empty, fitted to the numbers that it prints."""
