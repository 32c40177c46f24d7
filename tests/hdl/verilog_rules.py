"""What emitted Verilog must not have, found in its text: other clocks than the known ones, and asynchronous reads."""

import re

__all__ = ["clock_errors", "memory_errors"]


def clock_errors(text, clocks=("clk",)):
    """Sensitivity lists other than the clocks and the combinational one."""
    allowed = ["*", "(*)", *(f"(posedge {clock})" for clock in clocks)]
    return [at for at in re.findall(r"@\s*(\*|\([^)]*\))", text) if at not in allowed]


def memory_errors(text):
    """Uses of memories outside ``always @(posedge ...)`` and ``initial``, that is, asynchronous reads.

    This includes the form ``assign q = mem[registered_address]``, which vendors' tools may not infer as a
    memory block.
    """
    errors = []
    for module in re.split(r"^endmodule", text, flags=re.MULTILINE):
        memories = re.findall(r"^  reg (?:\[[^]]*\] )?(\S+) +\[\d+:\d+\];", module, re.MULTILINE)
        # Emission indents statements of a module by two spaces, and what belongs to them by more.
        for statement in re.split(r"^  (?! |end\b)", module, flags=re.MULTILINE):
            if statement.startswith(("always @(posedge ", "initial", "reg ")):
                continue
            uses = (re.search(rf"(?<!\w){re.escape(memory)} *\[", statement) for memory in memories)
            errors += [statement.strip() for use in uses if use]
    return errors
