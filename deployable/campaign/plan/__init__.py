"""Which runs a campaign has, under which names, and with which time step; and, with `order: auto`,
which runs come next."""
