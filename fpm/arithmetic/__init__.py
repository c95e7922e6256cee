"""Arithmetic with units: what text files of structures and definitions of quantities may state."""
