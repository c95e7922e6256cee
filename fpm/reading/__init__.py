"""What is read off a run: responses over time, quantities, forces, stresses, distances."""
