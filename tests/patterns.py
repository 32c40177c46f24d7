"""Binary frames that break naive connected component designs, and the frames that tests draw at random.

``directed()`` names every hand-made frame; ``variants`` turns one into its sixteen mirrored, flipped,
transposed and inverted forms. Foreground is True.
"""

import cv2
import numpy as np

__all__ = ["DENSITIES", "directed", "draw", "nested", "noise", "parse", "periodic", "smoothed", "variants"]

DENSITIES = (0.02, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.75, 0.9)


def parse(text):
    """The frame that rows of ``#`` and ``.`` show."""
    return np.array([[pixel == "#" for pixel in row] for row in text.split()])


def draw(frame, most=72):
    """A frame as text for a failure message; of a large one, only its size."""
    if max(frame.shape) > most:
        return f"({frame.shape[0]} rows of {frame.shape[1]})"
    return "\n".join("".join("#" if pixel else "." for pixel in row) for row in frame)


def periodic(text, rows, columns):
    """A frame tiled with a small one."""
    tile = parse(text)
    repeats = (-(-rows // tile.shape[0]), -(-columns // tile.shape[1]))
    return np.tile(tile, repeats)[:rows, :columns]


def variants(frame):
    """Yield ``(name, frame)`` of all sixteen forms of a frame."""
    for turned, start in (("", frame), ("transposed ", frame.T)):
        for mirrored, step_x in (("", 1), ("mirrored ", -1)):
            for flipped, step_y in (("", 1), ("flipped ", -1)):
                form = np.ascontiguousarray(start[::step_y, ::step_x])
                yield turned + mirrored + flipped, form
                yield turned + mirrored + flipped + "inverted ", ~form


#: Rows of known failures and of events that fall together.
SMALL = {
    "chain failure": ".....# ...#.# .##.#. #.....",
    "stale label": "#.....# #.####. .#.#...",
    "left edge and column W-2": "#..#. #..#. ####.",
    "left edge and column W-2, apart": "#..#. #..#. .....",
    "row end touches next row start": "....# #.... ....# #....",
    "runs end on both rows at once": "##.##.## ##.##.## .#..#..# ##.##.##",
    "merge and completion at once": "#.#.# .#..# ...#. .....",
    "one pixel U": "#.#.#.# #.#.#.# ###.###",
    "one pixel U at once": "#.# .#. #.# .#. #.#",
    "arches": "###.### #.#.#.# #.#.#.#",
    "full row": "####### ....... ####### #######",
    "full rows joined left": "####### #...... ####### ......# #######",
    "dot in a bowl": "#...# #.#.# #...# .###.",
    "bowl in a bowl": "#.......# #.#...#.# #.#.#.#.# #.#...#.# #..###..# .#.....#. ..#####..",
    "bowls side by side in a bowl": "#.........# #.#.#.#.#.# #..#...#..# #.........# .#########.",
    "hollow entry": "#.#.#.# ####### #.#.#.# #.###.# #.....# #######",
    "hand joins top": "..#.#.. .#...#. #.#.#.# .#.#.#. ..#.#..",
    "hand with run joins top with run": "..###.. .#...#. #.#.#.# #.#.#.# ..#.#.. .#...#.",
    "hand without run joins": "#.#.#.#.# ........# #.#.#.#.# .#.#.#.#. #...#...#",
    "two trees grow together": "#...#...# .#.#.#.#. ..#...#.. ...#.#... ....#....",
    "run loses its first mark in the clock that reads it": "..###### ..#....# ..#..#.# #.#.#.## ........",
    "the same, and goes on": "..###### ..#....# ..#..#.# #.#.#.## #.#.#.##",
    "one pixel": "#",
    "one column": "# . # # .",
    "one row": "##.#.###",
    "two columns": "#. .# .. #. #. .# ##",
}  # fmt: skip

#: Tiles of frames that go on for ever.
TILES = {
    "empty": ".",
    "full": "#",
    "checkerboard": "#. .#",
    "coarse checkerboard": "##.. ##.. ..## ..##",
    "isolated pixels": "#. ..",
    "vertical stripes": "#.",
    "wide vertical stripes": "##.",
    "dots and merging rows": "#. .# ..",
    "dots twice, then merge": "#. .. #. .# ..",
    "merge left and right": "#.#. .#.. ..#. .#.# ....",
    "diagonals": "#... .#.. ..#. ...#",
    "zigzag": "#... .#.# ..#.",
    "bowls": "#.#. #.#. .#..",
    "arches tile": ".#.. #.#. #.#. ....",
    "rings": "###. #.#. ###. ....",
    "dotted rings": ".###. #...# #.#.# #...# .###. .....",
    "bricks": "####. #.... ..### ..#..",
    "forks": "#.#.#.#. .#...#.. ..###... ........",
}  # fmt: skip


def staircase(teeth, joined="#"):
    """Teeth that begin one row apart, joined by a bar (or diagonally), with a tail under the leftmost."""
    frame = np.zeros((teeth + 3, 2 * teeth), dtype=bool)
    for tooth in range(teeth):
        frame[teeth - 1 - tooth : teeth, 2 * tooth] = True
    frame[teeth, : 2 * teeth - 1] = [joined == "#" or column % 2 == 1 for column in range(2 * teeth - 1)]
    frame[teeth + 1 :, 0] = True
    return frame


def comb(rows, columns, back):
    """Teeth of one pixel that hang from row ``back``."""
    frame = periodic("#.", rows, columns)
    frame[back] = True
    return frame


def nested(rows, columns, cut_rows=0):
    """Square rings in rings; without its first rows, bowls in bowls."""
    y, x = np.ogrid[: rows + cut_rows, :columns]
    border = np.minimum(np.minimum(y, rows + cut_rows - 1 - y), np.minimum(x, columns - 1 - x))
    return (border % 2 == 0)[cut_rows:]


def spiral(size):
    """One line of one pixel that winds to the middle."""
    frame = np.zeros((size + 2, size + 2), dtype=bool)
    y, x, down, right = 1, 1, 0, 1
    frame[1, 1] = True
    turns = 0
    while turns < 2:
        ahead = (y + 2 * down, x + 2 * right)
        inside = all(1 <= at <= size for at in (y + down, x + right))
        if inside and not frame[y + down, x + right] and not (max(ahead) < size + 2 and frame[ahead]):
            y, x, turns = y + down, x + right, 0
            frame[y, x] = True
        else:
            down, right, turns = right, -down, turns + 1
    return frame[1:-1, 1:-1]


def directed():
    """Name -> frame."""
    frames = {name: parse(text) for name, text in SMALL.items()}
    frames["merge and completion at the corner"] = parse("#.#.#.# .#.#.#. ......#")
    for name, tile in TILES.items():
        for rows, columns in ((6, 8), (7, 11), (9, 16), (17, 33)):
            frames[f"{name} {columns}x{rows}"] = periodic(tile, rows, columns)
    for teeth in range(2, 14):
        frames[f"staircase of {teeth}"] = staircase(teeth)
        frames[f"diagonal staircase of {teeth}"] = staircase(teeth, ".")
    for columns in (7, 12, 33):
        frames[f"comb {columns}"] = comb(9, columns, 0)
        frames[f"comb with its back in the middle {columns}"] = comb(9, columns, 4)
    for size in (5, 9, 16, 31):
        frames[f"nested rings {size}"] = nested(size, size)
        frames[f"nested bowls {size}"] = nested(size // 2, size, size // 2)
        frames[f"spiral {size}"] = spiral(size)
    for y in range(4):
        for x in range(5):
            frames[f"single pixel {x}, {y}"] = np.arange(20).reshape(4, 5) == 5 * y + x
    return frames


def noise(random, rows, columns, density):
    return random.random((rows, columns)) < density


def smoothed(random, rows, columns, sigma=1.0):
    """Noise, blurred and cut at a random level: shapes with smooth outlines."""
    field = cv2.GaussianBlur(random.random((rows, columns)).astype(np.float32), (0, 0), sigma)
    return field > np.quantile(field, random.uniform(0.2, 0.8))
