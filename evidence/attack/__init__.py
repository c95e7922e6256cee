"""Attacks on the program: what happens to it and its files that nobody wants.

    python -m evidence attack --minutes 60

kills processes, fills the disk, damages and swaps files, says structures in other words,
and changes the code to see whether the tests notice.
`ledger` counts; docs/trust.md tells what came out, and what is promised."""
