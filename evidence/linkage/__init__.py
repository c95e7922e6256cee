"""The paper's linkage, which most studies run: its runs and curves, and its rigid limit."""
