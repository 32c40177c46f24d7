"""The sensor's registers, all of them from one description, hdl/registers.rdl."""
