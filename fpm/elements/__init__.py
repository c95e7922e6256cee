"""What a scene is made of: one file per kind of element, each with its theory and its arrays."""
