"""The whole motion of a run: all particles, frames and strains."""
