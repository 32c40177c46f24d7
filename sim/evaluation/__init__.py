"""The sensor and its rivals on the same rendered frames: conditions, systems, sweeps, and the studies of the paper."""
