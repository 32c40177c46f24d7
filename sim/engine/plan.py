"""When every beat, setting and reset of a run happens: worked out once, played by every simulator alike.

Clock ``k`` is the ``k``-th rising edge of the run. What is driven for it is applied before that edge, and the
outputs are sampled just before it too, so a block with a latency of ``n`` clocks answers a beat of clock
``k`` in clock ``k + n``.
"""

import dataclasses

import numpy as np

__all__ = ["Captured", "Plan", "Run", "make_plan", "random_idle"]


@dataclasses.dataclass
class Captured:
    """Beats of one output, in order."""

    payload: np.ndarray  #: uint32 (N, words), least significant word first
    clock: np.ndarray  #: int64 (N,), the clock in which each was seen

    def __len__(self):
        return len(self.clock)


class Run(dict):
    """What a run brought: :class:`Captured` for every output stream and every plain output, by name."""

    def __init__(self, captured, plan):
        super().__init__(captured)
        self.clocks = plan.clocks  #: length of the run
        self.accepted = {name: clock for name, (clock, _) in plan.beats.items()}  #: clock of each input beat
        self.resets = plan.resets  #: clocks of the reset pulses


@dataclasses.dataclass
class Plan:
    """A schedule: everything is counted in clocks and sorted by them."""

    clocks: int  #: length of the run
    beats: dict  #: input stream -> (clock int64 (N,), payload uint64 (N,))
    change_clock: np.ndarray  #: int64: when a setting changes
    change_port: np.ndarray  #: int32: which one, as an index into ``interface.settings``
    change_value: np.ndarray  #: uint64: to what
    resets: np.ndarray  #: int64: when ``rst`` is high


def random_idle(count, chance, seed, longest=8):
    """Idle clocks before each of ``count`` beats: none, or with probability ``chance`` 1 to ``longest``."""
    random = np.random.default_rng(seed)
    return np.where(random.random(count) < chance, random.integers(1, longest + 1, count), 0)


def _beats(port, given):
    payload, idle = given if isinstance(given, tuple) else (given, None)
    payload = np.ascontiguousarray(payload, dtype=np.uint64)
    if payload.ndim != 1:
        raise ValueError(f"Payloads of {port.name!r} must be a flat array, not one of shape {payload.shape}")
    if port.width < 64 and (payload >> np.uint64(port.width)).any():
        raise ValueError(f"Payloads of {port.name!r} must fit in {port.width} bits")
    idle = np.broadcast_to(np.asarray(0 if idle is None else idle, dtype=np.int64), payload.shape)
    if (idle < 0).any():
        raise ValueError(f"Idle clocks of {port.name!r} must not be negative")
    return np.cumsum(idle + 1) - 1, payload


def make_plan(interface, inputs, config=None, *, drain_clocks=64, reset_at=()):
    """Schedule a run. See :meth:`sim.engine.stream.StreamEngine.run` for the arguments."""
    ports = {port.name: port for port in interface.inputs}
    settings = {port.name: index for index, port in enumerate(interface.settings)}
    for name in inputs:
        if name not in ports:
            raise ValueError(f"No input stream is called {name!r}; there are {', '.join(ports)}")
    for name in config or {}:
        if name not in settings:
            raise ValueError(f"No setting is called {name!r}; there are {', '.join(settings) or 'none'}")
    beats = {name: _beats(ports[name], inputs.get(name, [])) for name in ports}
    leader = next(iter(beats.values()))[0] if beats else np.zeros(0, dtype=np.int64)
    total = max((int(clock[-1]) + 1 for clock, _ in beats.values() if len(clock)), default=0)

    # A reset takes a clock of its own before its beat: whatever was due from then on moves up by one.
    reset_at = np.unique(np.asarray(reset_at, dtype=np.int64))
    if len(reset_at) and (reset_at[0] < 0 or reset_at[-1] >= len(leader)):
        raise ValueError(f"Resets must be at beats 0 to {len(leader) - 1}")
    due = leader[reset_at]
    resets = due + np.arange(len(due))
    beats = {
        name: (clock + np.searchsorted(due, clock, side="right"), payload) for name, (clock, payload) in beats.items()
    }
    leader = next(iter(beats.values()))[0] if beats else leader
    total += len(due)

    changes = []
    ends = np.append(leader, leader[-1] + 1 if len(leader) else 0)
    for name, given in (config or {}).items():
        width = interface.settings[settings[name]].width
        for beat, value in [(None, given)] if np.ndim(given) == 0 else given:
            if not 0 <= int(value) < 1 << width:
                raise ValueError(f"Setting {name!r} must fit in {width} bits, not {value!r}")
            if beat is not None and not 0 <= beat <= len(leader):
                raise ValueError(f"Setting {name!r} must change at a beat from 0 to {len(leader)}, not {beat}")
            clock = 0 if beat is None else int(ends[beat])
            changes.append((clock, settings[name], int(value)))
    changes.sort(key=lambda change: change[0])
    clocks, indices, values = zip(*changes, strict=True) if changes else ((), (), ())
    return Plan(
        total + drain_clocks,
        beats,
        np.array(clocks, dtype=np.int64),
        np.array(indices, dtype=np.int32),
        np.array(values, dtype=np.uint64),
        resets,
    )
