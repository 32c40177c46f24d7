"""Area and clock speed by open tools: estimates for Cyclone IV E, place and route for ECP5."""
