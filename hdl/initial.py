"""What memories begin with, as loops where words repeat: a large sensor's text else has a line for each of a million.

Yosys writes ``initial begin``, a line ``memory[k] = value;`` for each word, ``end``. Here words that are equal and
follow each other become a loop, in the form that Verilog-2001 allows and synthesis takes::

    initial begin : memory$begins
      integer word$;
      for (word$ = 0; word$ < 512; word$ = word$ + 1) memory[word$[8:0]] = 57'h0;
    end
"""

import itertools
import re

__all__ = ["with_loops"]

# Yosys writes a block for each memory; a name that needs a backslash ends with a space.
_INITIAL = re.compile(
    r"^  initial begin\n(    (\S+ ?)\[\d+\] = [^\n]+;\n(?:    \2\[\d+\] = [^\n]+;\n)*)  end\n", re.MULTILINE
)
_WORD = re.compile(r"\[(\d+)\] = ([^\n]+);\n")

_AROUND = "\\ "  # what an escaped name has before and behind it
_FEW = 4  # Fewer stay lines.
_MOST = 4096  # Quartus takes a loop of more than 5,000 for one without an end.


def with_loops(text):
    """Verilog as Yosys writes it -> the same with loops."""
    return _INITIAL.sub(_block, text)


def _block(found):
    name, words = found[2], [(int(place), value) for place, value in _WORD.findall(found[1])]
    # Places that follow each other differ from their numbers in the block by the same.
    runs = itertools.groupby(enumerate(words), lambda item: (item[1][0] - item[0], item[1][1]))
    parts = []
    for (_, value), run in runs:
        places = [place for _, (place, _) in run]
        parts += [(places[at : at + _MOST], value) for at in range(0, len(places), _MOST)]
    lines = "".join(_lines(name, *part) for part in parts)
    label = f" : \\{name.strip(_AROUND)}$begins \n    integer word$;" if "for (word$" in lines else ""
    return f"  initial begin{label}\n{lines}  end\n"


def _lines(name, places, value):
    if len(places) < _FEW:
        return "".join(f"    {name}[{place}] = {value};\n" for place in places)
    # As many bits as a place has: lint tools want no more.
    first, last = places[0], places[-1]
    word = f"word$[{last.bit_length() - 1}:0]"
    return f"    for (word$ = {first}; word$ < {last + 1}; word$ = word$ + 1) {name}[{word}] = {value};\n"
