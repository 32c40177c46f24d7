"""The Quartus project of the DE2-115. See ``python -m build.quartus``."""
