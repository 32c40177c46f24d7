"""TMDS as the standard describes it, and a monitor at the other end of the cable.

Source: Digital Visual Interface 1.0: figure 3-5 (encoder), figure 3-6 (decoder), section 3.2.2.
"""

import numpy as np

__all__ = ["CONTROL", "DviMonitor", "TmdsEncoder", "decode"]

#: Words of the two control bits; bit 0 goes over the wire first.
CONTROL = {0b00: 0x354, 0b01: 0x0AB, 0b10: 0x154, 0b11: 0x2AB}


class TmdsEncoder:
    """One channel: the standard's flow chart, with its names."""

    def __init__(self):
        self._cnt = 0

    def encode(self, data, control, active):
        """The word of one pixel."""
        if not active:
            self._cnt = 0
            return CONTROL[control]
        d = [data >> k & 1 for k in range(8)]
        uses_xnor = sum(d) > 4 or (sum(d) == 4 and d[0] == 0)
        q_m = [d[0]]
        for k in range(1, 8):
            q_m.append(int(q_m[-1] == d[k]) if uses_xnor else q_m[-1] ^ d[k])
        q_m.append(int(not uses_xnor))
        n1 = sum(q_m[:8])
        n0 = 8 - n1
        if self._cnt == 0 or n1 == n0:
            inverts = q_m[8] == 0
            self._cnt += n0 - n1 if inverts else n1 - n0
        elif (self._cnt > 0 and n1 > n0) or (self._cnt < 0 and n0 > n1):
            inverts = True
            self._cnt += 2 * q_m[8] + n0 - n1
        else:
            inverts = False
            self._cnt += -2 * (1 - q_m[8]) + n1 - n0
        bits = [bit ^ inverts for bit in q_m[:8]] + [q_m[8], int(inverts)]
        return sum(bit << k for k, bit in enumerate(bits))


def decode(words):
    """(data, control, active) arrays of a channel's words."""
    words = np.asarray(words)
    low = np.where(words >> 9 & 1, ~words, words) & 255
    shifted = low << 1 & 255
    data = np.where(words >> 8 & 1, low ^ shifted, ~(low ^ shifted) & 255)
    data = (data & 254) | (low & 1)
    control, active = np.zeros(len(words), int), np.ones(len(words), bool)
    for value, word in CONTROL.items():
        control[words == word] = value
        active[words == word] = False
    return data, control, active


class DviMonitor:
    """Three channels and a clock, each a series of bits, to what a monitor's picture is made of."""

    def _words(self, bits, name):
        """Words of a channel, which begin where most control words are found."""
        bits = np.asarray(bits, np.int64)
        values = np.convolve(bits, 1 << np.arange(10)[::-1])[9:]  # of the word that begins at each bit
        hits = [np.isin(values[phase::10], list(CONTROL.values())).sum() for phase in range(10)]
        if not max(hits) > 0.05 * len(bits) / 10:
            raise ValueError(f"channel {name} has no blanking")
        return values[int(np.argmax(hits)) :: 10][: (len(bits) - 9) // 10 - 1], int(np.argmax(hits))

    def receive(self, blue, green, red, clock):
        """(hsync, vsync, rgb, active) of each pixel clock.

        Raises
        ------
        ValueError
            If a channel has no blanking to find its words by, a blanking of its own, or the clock does not fit.
        """
        channels, phases = {}, set()
        for name, bits in (("b", blue), ("g", green), ("r", red)):
            words, phase = self._words(bits, name)
            channels[name] = decode(words)
            phases.add(phase)
        if len(phases) > 1:
            raise ValueError("the channels are not in step")
        ticks = np.asarray(clock)[phases.pop() :]
        ticks = ticks[: len(ticks) // 10 * 10].reshape(-1, 10)
        if not (ticks == ticks[0]).all() or (np.diff(np.append(ticks[0], ticks[0][0])) == 1).sum() != 1:
            raise ValueError("the clock does not have the period of a word")
        _, control, active = channels["b"]
        for name in "gr":
            if (channels[name][2] != active).any() or channels[name][1].any():
                raise ValueError(f"channel {name} has a blanking of its own")
        # The sync lines keep their levels while there are colours.
        blank = np.where(active, 0, np.arange(len(active)))
        blank[0] = np.argmin(active)
        control = control[np.maximum.accumulate(blank)]
        rgb = np.stack([np.where(active, channels[name][0], 0) for name in "rgb"], axis=1)
        return control & 1, control >> 1, rgb, active
