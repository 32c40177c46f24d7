"""``python -m sim``: the sensor at the command line."""

import sys

from sim.cli.app import main

if __name__ == "__main__":
    sys.exit(main())
