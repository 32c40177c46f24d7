"""A sweep that a user makes: the same work as the report's, its entry of the same form, and its plot."""

from sim.evaluation.conditions import PARAMETERS
from sim.evaluation.frames import collect, rtl_jobs, rtl_summary, sweep_jobs
from sim.evaluation.pool import run_jobs
from sim.evaluation.store import Store
from sim.evaluation.systems import SYSTEMS
from sim.report.results import checked_equal
from sim.report.sweep_plots import draw_sweep

__all__ = ["PLOT_ENDS", "run_sweep", "write_plot"]

PLOT_ENDS = (".png", ".svg", ".pdf")


def run_sweep(sweep, frames, systems, rtl_frames, sample_seed, *, store=None, dask=None, **how):
    """The entry of a Sweep, as results.json has them; ``how`` is for ``run_jobs``.

    Raises
    ------
    UnequalError
        A frame of the sample differs between Verilog and model.
    ClusterError, EngineError
        From what they come of.
    """
    store = store or Store()
    groups = sweep_jobs(sweep, sweep.values, frames, systems)
    results = iter(run_jobs([job for group in groups for job in group], store, dask=dask, title="frames", **how))
    chunks = [[next(results) for _ in group] for group in groups]
    checks = rtl_jobs(sweep, sweep.values, frames, rtl_frames, sample_seed)
    answers = run_jobs(checks, store, title="Verilog", **how)
    parameter = PARAMETERS[sweep.parameter]
    entry = {
        "title": parameter.title,
        "unit": parameter.unit,
        **collect(sweep, sweep.values, frames, chunks, systems),
        "rtl": rtl_summary(checks, answers, sample_seed),
    }
    checked_equal({sweep.parameter: entry})
    return entry


def write_plot(entry, path):
    """Plot an entry; the file's kind is that of its name."""
    titles = {name: {"title": SYSTEMS[name].title} for name in entry["systems"]}
    draw_sweep(entry, titles).savefig(path, dpi=140, facecolor="white")
