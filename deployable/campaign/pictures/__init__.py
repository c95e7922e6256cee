"""Pictures of structures: any structure, still or moving, from its motion."""
