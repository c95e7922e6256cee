"""Which runs a campaign has, under which names, and with which time step; and, towards an
`accuracy`, which runs come next."""
