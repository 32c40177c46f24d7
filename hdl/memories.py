"""What synthesis is told about memories."""

__all__ = ["NO_COLLISIONS", "NO_COLLISIONS_IN_BLOCK"]

#: Attributes of a memory of which no read that meets a write to the same address in the same clock is used, so that its
#: outcome does not matter. ECP5 block RAM returns anything then; without this promise Yosys builds a bypass behind it,
#: and the data can no longer be registered in the block RAM itself. ``tests/hdl/test_collisions.py`` has garbage read.
NO_COLLISIONS = {"no_rw_check": 1}

#: The same of a memory that is to be in block RAM, because its data would come too late through the multiplexers of a
#: distributed one. Quartus does not know this attribute and decides by itself.
NO_COLLISIONS_IN_BLOCK = NO_COLLISIONS | {"ram_style": "block"}
