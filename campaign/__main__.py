"""Check configs without running anything: `python -m campaign config/paper.yaml ...`."""

from __future__ import annotations

import sys


def main(paths: list[str]) -> int:
    """Check each file; 0 when all of them can be used."""
    from campaign.config import load_config
    from campaign.errors import ConfigError
    from campaign.nodes import count_runs

    if not paths or {"-h", "--help"} & set(paths):
        print(__doc__, file=sys.stdout if paths else sys.stderr)
        return 0 if paths else 2
    status = 0
    for path in paths:
        try:
            config = load_config([path])
        except ConfigError as error:
            print(error, file=sys.stderr)
            status = 1
        else:
            print(f"{path}: {config['campaign']}, at most {count_runs(config)} runs")
    return status


sys.exit(main(sys.argv[1:]))
