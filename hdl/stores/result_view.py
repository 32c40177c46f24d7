"""The stores' published lists, as a display reads them.

Contract: in a clock with ``free`` set the three ``index`` are taken, and in the next clock ``data`` has the items of
those numbers; in other clocks the register bus has the stores' read ports and nothing is taken. Never is the bus
delayed. An item exists if, in the clock in which its number was taken, that was less than ``count``. ``count`` and
``bank`` change in one clock, in which the list is exchanged for another frame's; the exchange may come in any clock,
and the lists are not exchanged together (see :class:`~hdl.stores.publisher.Publisher`), so whoever reads without
holding the results sees whole items of published lists, but not always lists of one frame.
"""

from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["ResultView", "StoreView"]


class StoreView(wiring.Signature):
    """One list. Directions are as the reader's side sees them.

    Parameters
    ----------
    shape : shape-like
        An item.
    depth : int
        Most items.

    Members
    -------
    index : :py:`Out(range(depth))`
        Number of the item to read.
    data : :py:`In(shape)`
        That item, one clock after its number was taken.
    count : :py:`In(range(depth + 1))`
        Items of the published list.
    bank : :py:`In(1)`
        Changes with each exchange.
    """

    def __init__(self, *, shape, depth):
        super().__init__({"index": Out(range(depth)), "data": In(shape), "count": In(range(depth + 1)), "bank": In(1)})


class ResultView(wiring.Signature):
    """All lists. Directions are as the reader's side sees them.

    Parameters
    ----------
    blobs, corners, markers : (shape-like, int)
        An item of each list, and most items.

    Members
    -------
    free : :py:`In(1)`
        The bus does not read in this clock.
    published : :py:`In(1)`
        Strobe: a frame's last list was exchanged.
    blobs, corners, markers : :py:`Out(StoreView(...))`
    """

    def __init__(self, *, blobs, corners, markers):
        lists = {"blobs": blobs, "corners": corners, "markers": markers}
        super().__init__(
            {"free": In(1), "published": In(1)}
            | {name: Out(StoreView(shape=shape, depth=depth)) for name, (shape, depth) in lists.items()}
        )
