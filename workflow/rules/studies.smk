# Studies of the program itself: verification, extremes, benchmark, tradeoff.
# Each leaves results/<target>/summary.json, a table and plots.
