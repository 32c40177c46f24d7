"""Where everything lies in the processor's address space."""

__all__ = ["RAM", "REGISTERS", "REGISTERS_SIZE"]

#: First byte of the memory.
RAM = 0

#: First byte of the registers, and bytes from there on that are theirs, in use or not.
REGISTERS, REGISTERS_SIZE = 0xF000_0000, 0x2_0000
