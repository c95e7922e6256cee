"""`python -m campaign`."""

import os
import sys

# As Snakemake's jobs have it: more threads of linear algebra round otherwise, and gain nothing here.
os.environ.setdefault("OMP_NUM_THREADS", "1")

from campaign.cli import main

sys.exit(main(sys.argv[1:]))
