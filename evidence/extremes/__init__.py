"""Where the method holds: the linkage at the ends of its parameters' ranges."""
