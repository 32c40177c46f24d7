"""The floating-point unit's port: what a CPU may do to it, in both simulators, clock by clock."""

import numpy as np

from hdl import emit
from hdl.float.unit import CLOCKS
from sim.models.float import FUNCTIONS, NAN, compute, operation
from tests.hdl.float_bench import adversarial, function_of
from tests.hdl.harness import simulate

NAMES = tuple(FUNCTIONS)


def make_commands(count, seed, unknown=0.05):
    """Rows of (function, a, b): operations in random order, some of them unknown."""
    random = np.random.default_rng(seed)
    functions = np.array([function_of(name, mode) for name in NAMES for mode in FUNCTIONS[name][1]])
    function = random.choice(functions, count)
    function = np.where(random.random(count) < unknown, random.integers(0, 1024, count), function)
    return np.stack([function, *adversarial(count, seed)], axis=1).astype(np.int64)


def answer(function, a, b):
    """(result, clocks) of a command."""
    known = operation(function)
    if known is None:
        return NAN, 1
    name, mode = known
    return int(compute(name, np.array([a], np.uint32), np.array([b], np.uint32), mode)[0]), CLOCKS[name]


def play(simulator, commands, *, idle=0, ready=None, reset=None, clocks=None):
    """What the port shows in every clock."""
    clocks = clocks or 5 * len(commands) + 100
    plan = {
        "command": commands,
        "idle": np.broadcast_to(idle, len(commands)),
        "ready": np.ones(clocks, bool) if ready is None else ready[:clocks],
        "reset": np.zeros(clocks, bool) if reset is None else reset[:clocks],
    }
    verilog = emit.emit("float_unit")
    return plan, simulate("float_unit", verilog, simulator, plan, size="unit", testbench="tests.hdl.tb_float")


def check(plan, seen):
    """Every clock is as the contract has it: foreseen with one variable, the response that is due, and when."""
    commands = plan["command"].tolist()
    result = due = None
    latest = answered = 0
    for clock in range(len(seen["valid"])):
        if plan["reset"][clock]:
            result = due = None
            continue
        valid = due is not None and clock >= due
        assert seen["valid"][clock] == valid, f"clock {clock}: valid is {seen['valid'][clock]}, due is {due}"
        if valid:
            assert seen["payload"][clock] == result, f"clock {clock}: {seen['payload'][clock]:08x}, not {result:08x}"
            if plan["ready"][clock]:
                result = due = None
                answered += 1
        taken = seen["taken"][clock]
        if taken >= 0:
            assert due is None, f"clock {clock}: a second command was taken"
            latest = taken
            result, latency = answer(*commands[taken])
            due = clock + latency
    assert latest == len(commands) - 1 and due is None, "the run was too short"
    return answered


def test_back_to_back(simulator):
    """The next command is taken in the clock in which a response is."""
    commands = make_commands(400, seed=1)
    plan, seen = play(simulator, commands)
    assert check(plan, seen) == len(commands)
    taken = np.flatnonzero(seen["taken"] >= 0)
    latency = [answer(*command)[1] for command in commands.tolist()]
    assert np.diff(taken).tolist() == latency[:-1]
    assert set(latency) == {1, 2, 3, 13, 14}


def test_stalls_and_idle_clocks(simulator):
    """Ready is rare, even and frequent in turn, comes in single clocks, and then for long not at all."""
    commands = make_commands(600, seed=2)
    random = np.random.default_rng(3)
    idle = np.where(random.random(600) < 0.5, random.integers(0, 20, 600), 0)
    phases = [
        random.random(500) < 0.1,
        random.random(500) < 0.5,
        random.random(1000) < 0.9,
        random.integers(0, 7, 600) == 0,
        np.arange(1200) % 60 == 59,
    ]
    ready = np.concatenate([*phases, np.ones(8200, bool)])
    plan, seen = play(simulator, commands, idle=idle, ready=ready, clocks=12000)
    assert check(plan, seen) == len(commands)
    waits = seen["valid"].astype(bool) & ~plan["ready"]
    ends = np.cumsum([len(phase) for phase in phases])
    for part in np.split(waits, ends)[:-1]:
        assert part.sum() > 5


def test_every_unknown_function_is_answered(simulator):
    functions = [function for function in range(1024) if operation(function) is None]
    assert len(functions) == 997
    random = np.random.default_rng(7)
    commands = np.stack([functions, *random.integers(0, 1 << 32, (2, len(functions)))], axis=1)
    plan, seen = play(simulator, commands, clocks=1100)
    assert check(plan, seen) == len(functions)
    assert (seen["payload"][seen["valid"] == 1] == NAN).all()


def test_no_response_without_a_command(simulator):
    """Junk is on the payload; one command long after reset ends the run."""
    commands = make_commands(1, seed=8)
    plan, seen = play(simulator, commands, idle=600, clocks=650)
    assert check(plan, seen) == 1
    assert seen["valid"].sum() == 1


def test_reset_in_every_clock_of_an_operation(simulator):
    """What was under way is forgotten; the command after it is answered as ever."""
    names = ["fdiv"] * 30 + ["fsqrt"] * 30 + ["fadd", "fmul", "feq"] * 20
    commands = np.array([(function_of(name), 0x40490FDB, 0x00000123) for name in names], np.int64)
    # Resets at growing distances from each other: each hits another clock of a command.
    reset = np.zeros(1500, bool)
    reset[np.cumsum(np.tile(np.arange(2, 18), 6))] = True
    plan, seen = play(simulator, commands, idle=1, reset=reset, clocks=1500)
    answered = check(plan, seen)
    assert 40 < answered < len(commands) - 20
