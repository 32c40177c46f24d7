"""From a camera's pins to the sensor's stream: set-up, capture, colours, and the way to the system's clock."""
