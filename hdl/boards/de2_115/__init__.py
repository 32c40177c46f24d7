"""Terasic's DE2-115: a Cyclone IV E (EP4CE115F29C7) with a D5M camera on JP5."""
