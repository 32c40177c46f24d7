"""What test_framer.py feeds the framer, and what must come out: its docstring's table, pixel by pixel."""

import dataclasses

import numpy as np

from sim.engine import random_idle

__all__ = ["HEIGHT", "SEQUENCES", "WIDTH", "Said", "Stream", "fuzz", "reference"]

#: The size that the block under test is built for.
WIDTH, HEIGHT = 9, 7


@dataclasses.dataclass
class Stream:
    """A camera's pixels and the settings as they are when each comes; one entry for each pixel."""

    sof: list
    eol: list
    columns: list
    rows: list
    enable: list
    idle: np.ndarray  #: clocks without a pixel before each

    @classmethod
    def of(cls, pixels, size, idle=0):
        """Of a text as in :data:`SEQUENCES`."""
        enable = [pixel not in "sb" for pixel in pixels]
        sof, eol = ([pixel in kind for pixel in pixels] for kind in ("SsBb", "|Bb"))
        columns, rows = ([value] * len(pixels) for value in size)
        return cls(sof, eol, columns, rows, enable, np.broadcast_to(idle, len(pixels)))

    def __add__(self, other):
        lists = zip(dataclasses.astuple(self), dataclasses.astuple(other), strict=True)
        return Stream(*(np.concatenate(pair).tolist() for pair in lists))

    @property
    def clock(self):
        """The clock of every pixel."""
        return np.cumsum(np.asarray(self.idle, dtype=np.int64) + 1) - 1


@dataclasses.dataclass
class Said:
    """What must come out, and what led to it."""

    sent: list = dataclasses.field(default_factory=list)  #: (beat, first, eol, last)
    errors: list = dataclasses.field(default_factory=list)  #: (beat, kind)
    taken: list = dataclasses.field(default_factory=list)  #: (beat, columns, rows)
    ignored: list = dataclasses.field(default_factory=list)  #: standing in which a start was ignored
    changed: list = dataclasses.field(default_factory=list)  #: clocks by which a new size came after settling


def reference(stream, smallest=1):
    """The table, one pixel at a time."""
    said = Said()
    standing, position, size, settles = "waiting", 0, (0, 0), -1
    clocks = stream.clock.tolist()
    for beat, (starts, ends) in enumerate(zip(stream.sof, stream.eol, strict=True)):
        if starts:
            if standing == "running":
                said.errors.append((beat, "midline_start" if position % size[0] else "short_frame"))
            new = stream.columns[beat], stream.rows[beat]
            is_possible = smallest <= new[0] <= WIDTH and smallest <= new[1] <= HEIGHT
            if not stream.enable[beat]:
                said.ignored.append(standing)
                standing = "waiting"
            elif is_possible and (new == size or clocks[beat] > settles):
                if new != size and settles >= 0:
                    said.changed.append(clocks[beat] - settles)
                said.taken.append((beat, *new))
                standing, size, position = "running", new, 0
            else:
                if is_possible:
                    said.changed.append(clocks[beat] - settles)
                said.errors.append((beat, "bad_size"))
                standing = "waiting"
        elif standing == "complete":
            said.errors.append((beat, "long_frame"))
            standing = "waiting"
        if standing != "running":
            continue
        in_last_column = position % size[0] == size[0] - 1
        if ends and in_last_column:
            complete = position // size[0] == size[1] - 1
            said.sent.append((beat, position == 0, True, complete))
            if complete:
                standing, settles = "complete", clocks[beat] + size[0] + 64
        elif ends or in_last_column:
            said.errors.append((beat, "short_line" if ends else "long_line"))
            standing = "waiting"
        else:
            said.sent.append((beat, position == 0, False, False))
        position += 1
    return said


#: Name -> (pixels, size, errors). S starts a frame, | ends a row, B does both, . does neither. s and b are
#: S and B while ``enable`` is 0.
SEQUENCES = {
    "good": ("S.|..|S.|..|", (3, 2), []),
    "ignored before the first start": ("..|.|S.|..|", (3, 2), []),
    "one pixel frames": ("BBB", (1, 1), []),
    "one column": ("B|B|", (1, 2), []),
    "one row": ("S.|S.|", (3, 1), []),
    "short line": ("S.|.|..|S.|..|", (3, 2), [(4, "short_line")]),
    "short line that would end the frame": ("S.|.|S.|..|", (3, 2), [(4, "short_line")]),
    "short first pixel": ("B..|S.|..|", (3, 2), [(0, "short_line")]),
    "long line": ("S.....|S.|..|", (3, 2), [(2, "long_line")]),
    "long last line": ("S.|...|S.|..|", (3, 2), [(5, "long_line")]),
    "long line of one column": ("SB|", (1, 2), [(0, "long_line")]),
    "long only pixel": ("S|B", (1, 1), [(0, "long_line")]),
    "short frame": ("S.|S.|..|", (3, 2), [(3, "short_frame")]),
    "short frame of one column": ("BB|", (1, 2), [(1, "short_frame")]),
    "start within a row": ("S.|.S.|..|", (3, 2), [(4, "midline_start")]),
    "start upon start": ("SS.|..|", (3, 2), [(1, "midline_start")]),
    "start where the row should end": ("S.S.|..|", (3, 2), [(2, "midline_start")]),
    "start with eol where the row should end": (
        "S.B.|..|S.|..|",
        (3, 2),
        [(2, "midline_start"), (2, "short_line")],
    ),
    "start after a row without eol": ("S..S.|..|", (3, 2), [(2, "long_line")]),
    "long frame": ("S.|..|..|..|S.|..|", (3, 2), [(6, "long_frame")]),
    "long frame by one pixel": ("S.|..|.S.|..|", (3, 2), [(6, "long_frame")]),
    "long frame of one pixel": ("B|.|B", (1, 1), [(1, "long_frame")]),
    "ignored": ("s.|..|S.|..|", (3, 2), []),
    "ignored within a frame": ("S.|.s.|..|S.|..|", (3, 2), [(4, "midline_start")]),
    "ignored instead of a row": ("S.|s.|..|S.|..|", (3, 2), [(3, "short_frame")]),
    "ignored after a complete frame": ("S.|..|s.|..|..S.|..|", (3, 2), []),
    "ignored after a long frame": ("S.|..|.s.|..|S.|..|", (3, 2), [(6, "long_frame")]),
    "ignored and wrong": ("s|....b.|S.|..|", (3, 2), []),
    "ignored one pixel frame": ("BbB", (1, 1), []),
    "ignored without columns": ("s.|..|", (0, 2), []),
    "ignored without columns within a column": ("SsS", (0, 2), [(0, "bad_size"), (2, "bad_size")]),
    "no columns": ("S.|..|", (0, 2), [(0, "bad_size")]),
    "no rows": ("S.|..|", (3, 0), [(0, "bad_size")]),
    "too many columns": ("S.|..|", (WIDTH + 1, 2), [(0, "bad_size")]),
    "too many rows": ("S.|..|", (3, HEIGHT + 1), [(0, "bad_size")]),
    "far too many columns": ("S.|..|", (3 + 16, 2), [(0, "bad_size")]),
    "far too many rows": ("S.|..|", (3, 2 + 256), [(0, "bad_size")]),
    "largest frame": (
        "S" + "." * (WIDTH - 2) + "|" + ("." * (WIDTH - 1) + "|") * (HEIGHT - 1),
        (WIDTH, HEIGHT),
        [],
    ),
}


def fuzz(seed, count=40):
    """Good, damaged and ignored frames; sizes change before and after settling, and settings all the time."""
    random = np.random.default_rng(seed)
    sizes = ([1, 1], [WIDTH + 1, HEIGHT + 1])
    parts, size, settling = [], random.integers(*sizes), 0
    for _ in range(count):
        gap = 0
        if random.random() < 0.4:
            size = random.integers(*sizes)
            gap = max(0, settling + random.choice([-9, -2, -1, 0, 1, 50], p=[0.1, 0.1, 0.1, 0.1, 0.1, 0.5]))
        across, down = map(int, size)
        if random.random() < 0.05:
            across, down = [(0, down), (across, 0), (WIDTH + 1, down), (across, HEIGHT + 1)][random.integers(4)]
        index = np.arange(max(1, across * down))
        marks = np.stack([index == 0, index % max(1, across) == across - 1])
        if random.random() < 0.4:  # Damage it: cut it, repeat an end of it, or flip marks.
            kind = random.integers(3)
            if kind == 0:
                marks = marks[:, : random.integers(1, len(index) + 1)]
            elif kind == 1:
                marks = np.concatenate([marks, marks[:, random.integers(len(index)) :] & [[False], [True]]], axis=1)
            else:
                marks[random.integers(2), random.integers(len(index))] ^= True
        settings = np.tile([[across], [down], [1]], marks.shape[1])
        settings[2, 0] = random.random() > 0.08
        late = random.random(marks.shape[1]) < 0.3  # Settings that change within the frame must not count.
        noise = [*random.integers(0, WIDTH + 2, 2), random.integers(2)]
        settings[:, late & ~marks[0]] = np.array(noise)[:, np.newaxis]
        idle = random_idle(marks.shape[1], [0, 0.5, 0.9][seed % 3], int(random.integers(2**32)))
        idle[0] = gap
        parts.append((*marks, *settings, idle))
        settling = across + 64
    return Stream(*(np.concatenate(values).tolist() for values in zip(*parts, strict=True)))
