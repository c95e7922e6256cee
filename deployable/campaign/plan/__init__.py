"""Which runs a campaign has, their names and time step; towards an `accuracy`, which come next."""
