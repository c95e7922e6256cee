"""How values are written: numbers as people write them, and quantities in words."""
