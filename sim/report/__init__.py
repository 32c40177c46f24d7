"""The evaluation as a page that a person wants to look at, and as results.json."""
