"""What the processor has besides its memory and the sensor. Each peripheral holds its own registers."""
