"""The sensor as its user meets it: the command line, and the figures of the bench."""
