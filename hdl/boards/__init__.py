"""Boards: what pins and vendors' cells need. Nothing below this folder is needed by anything outside of it."""
