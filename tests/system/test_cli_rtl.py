"""The commands give the same JSON with the Verilog as with the model."""

import pytest

from sim.cli.app import main


@pytest.fixture(scope="module")
def built(pictures, tmp_path_factory):
    """Skips where no engine can be built; builds it otherwise."""
    from sim.engine.build import EngineError, verilator_root

    try:
        verilator_root()
    except EngineError as error:
        pytest.skip(str(error))
    out = tmp_path_factory.mktemp("built")
    assert main(["run", str(pictures / "least.png"), "--out", str(out)]) == 0


@pytest.mark.usefixtures("built")
@pytest.mark.parametrize("name", ["three", "paper", "noise", "least"])
def test_run(sim, pictures, name):
    def frame(engine):
        args = ("run", pictures / f"{name}.png", "--no-overlay", "--json", "-", "--engine", engine)
        (only,) = sim(*args).json()["frames"]
        return only

    rtl, model = frame("rtl"), frame("model")
    assert (rtl["clocks"], rtl["engine"]) == (rtl["width"] * rtl["height"], "rtl")
    assert rtl == {**model, "engine": "rtl", "clocks": rtl["clocks"]}


@pytest.mark.usefixtures("built")
@pytest.mark.parametrize(
    "command", [["blobs"], ["blobs", "--threshold", "60"], ["corners"], ["corners", "--no-suppression"]]
)
@pytest.mark.parametrize("name", ["three", "noise"])
def test_blocks(sim, pictures, command, name):
    rtl, model = (sim(*command, pictures / f"{name}.png", "--engine", engine).json() for engine in ("rtl", "model"))
    assert rtl == model
