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

_INITIAL = re.compile(r"^  initial begin\n((?:    [^\n]+\[\d+\] = [^\n]+;\n)+)  end\n", re.MULTILINE)
_WORD = re.compile(r"    (\S+) ?\[(\d+)\] = ([^\n]+);\n")

_FEW = 4  # Fewer stay lines.
_MOST = 4096  # Quartus takes a loop of more than 5,000 for one without an end.


def with_loops(text):
    """Verilog as Yosys writes it -> the same with loops."""
    return _INITIAL.sub(_block, text)


def _block(found):
    words = [(name, int(place), value) for name, place, value in _WORD.findall(found[1])]
    name = words[0][0]
    lines, has_loop = [], False
    # Of words that follow each other the difference is the same.
    runs = itertools.groupby(enumerate(words), lambda word: (word[1][0], word[1][1] - word[0], word[1][2]))
    for (_, _, value), run in runs:
        places = [place for _, (_, place, _) in run]
        for at in range(0, len(places), _MOST):
            part = places[at : at + _MOST]
            if len(part) < _FEW:
                lines += [f"    {name} [{place}] = {value};\n" for place in part]
                continue
            has_loop = True
            # As many bits as a place has: lint tools want no more.
            word = f"word$[{max(part[-1].bit_length(), 1) - 1}:0]"
            lines.append(
                f"    for (word$ = {part[0]}; word$ < {part[-1] + 1}; word$ = word$ + 1) {name} [{word}] = {value};\n"
            )
    label = f" : \\{name.lstrip(chr(92))}$begins \n    integer word$;" if has_loop else ""
    return f"  initial begin{label}\n{''.join(lines)}  end\n"
