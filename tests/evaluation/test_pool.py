"""Jobs: kept, taken up again after an interruption, the same on one process, on two and on a Dask cluster."""

import itertools

import pytest
from distributed import LocalCluster

from sim.evaluation import pool
from sim.evaluation.frames import check_frames, collect, rtl_jobs, rtl_summary, sweep_jobs
from sim.evaluation.jobs import Job, run_job
from sim.evaluation.pool import ClusterError, run_jobs
from sim.evaluation.store import Store
from sim.evaluation.sweeps import SWEEPS

DOUBLES = [Job("tests.evaluation.work:double", {"number": number}) for number in range(6)]


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path)


@pytest.fixture
def calls(monkeypatch):
    """Jobs that are really done, in this process."""
    done = []
    monkeypatch.setattr(pool, "run_job", lambda job: done.append(job) or run_job(job))
    return done


def test_results_are_in_the_order_of_the_jobs_and_kept(store, calls):
    assert run_jobs(DOUBLES, store, workers=1) == [0, 2, 4, 6, 8, 10]
    assert calls == DOUBLES
    assert run_jobs([*DOUBLES[3:], DOUBLES[0]], store, workers=1) == [6, 8, 10, 0]
    assert calls == DOUBLES


def test_goes_on_where_it_was_interrupted(store, calls):
    def interrupted(items, description, total):
        yield from itertools.islice(items, 3)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_jobs(DOUBLES, store, workers=1, progress=interrupted)
    kept = [job for job in DOUBLES if store.has(job)]
    assert len(kept) == 3
    assert run_jobs(DOUBLES, store, workers=1) == [0, 2, 4, 6, 8, 10]
    assert [calls.count(job) for job in kept] == [1, 1, 1]


def test_a_job_is_its_function_and_arguments():
    job = Job("tests.evaluation.work:double", {"number": 2})
    assert job.key == Job("tests.evaluation.work:double", {"number": 2}).key
    assert job.key != Job("tests.evaluation.work:double", {"number": 3}).key
    assert job.key != Job("tests.evaluation.work:other", {"number": 2}).key


def test_two_processes(tmp_path):
    """Real frames: the rows that other processes send are those of this one."""
    jobs = [job for group in sweep_jobs(SWEEPS["noise"], (3, 10), 2, ["rasterpose"]) for job in group]
    assert run_jobs(jobs, Store(tmp_path), workers=2) == [run_job(job) for job in jobs]


def test_dask_cluster_with_two_workers(tmp_path):
    jobs = [job for group in sweep_jobs(SWEEPS["noise"], (3, 10), 2, ["rasterpose"]) for job in group]
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        address = cluster.scheduler_address
        assert address.startswith("tcp://")
        assert run_jobs(jobs, Store(tmp_path), dask=address) == [run_job(job) for job in jobs]


def test_cluster_without_workers_and_with_other_sources(tmp_path, monkeypatch):
    with LocalCluster(n_workers=0, dashboard_address=None) as cluster:
        with pytest.raises(ClusterError, match="has no workers"):
            run_jobs(DOUBLES, Store(tmp_path), dask=cluster.scheduler_address)
        cluster.scale(1)
        cluster.wait_for_workers(1)
        monkeypatch.setattr(pool, "code_digest", lambda: "other")
        with pytest.raises(ClusterError, match="does not have these sources"):
            run_jobs(DOUBLES, Store(tmp_path), dask=cluster.scheduler_address)


def test_no_cluster(tmp_path, monkeypatch):
    monkeypatch.setattr(pool, "_PATIENCE_S", 0.3)
    with pytest.raises(ClusterError, match=r"no Dask scheduler answers at tcp://127\.0\.0\.1:9"):
        run_jobs(DOUBLES, Store(tmp_path), dask="tcp://127.0.0.1:9")


def test_collected_figures_are_those_of_the_rows(store):
    sweep, systems = SWEEPS["contrast"], ["rasterpose", "aruco_subpix"]
    groups = sweep_jobs(sweep, (10, 160), 6, systems)
    assert [len(group) for group in groups] == [2, 2]
    results = [run_jobs(group, store, workers=1) for group in groups]
    entry = collect(sweep, (10, 160), 6, results, systems)
    assert (entry["parameter"], entry["values"], entry["frames"], entry["seeds"]) == ("contrast", [10, 160], 6, [0, 5])
    assert entry["base"]["noise"] == 3 and set(entry["systems"]) == set(systems)
    assert entry["systems"]["rasterpose"]["found_rate"][1] == 1
    lines, corners = (entry["systems"][name]["vertex_rms_px"][1] for name in ("rasterpose", "aruco_subpix"))
    assert 0 < lines < 0.1 < corners < 0.5


def test_sample_is_drawn_by_its_seed_and_equal_in_the_verilog(store):
    sweep = SWEEPS["noise"]
    jobs = rtl_jobs(sweep, (3, 20), 40, 2, seed=1)
    assert jobs == rtl_jobs(sweep, (3, 20), 40, 2, seed=1) != rtl_jobs(sweep, (3, 20), 40, 2, seed=2)
    summary = rtl_summary(jobs, run_jobs(jobs, store, workers=1), 1)
    assert (summary["frames"], summary["sample_seed"], summary["unequal"]) == (2, 1, [])
    every = rtl_jobs(sweep, (3, 20), 2, 99, seed=1)
    drawn = [(frame[0]["noise"], frame[1]) for job in every for frame in job.arguments["frames"]]
    assert sorted(drawn) == [(3, 0), (3, 1), (20, 0), (20, 1)]


def test_a_frame_that_differs_is_told(monkeypatch):
    from sim.evaluation import frames
    from sim.models.sensor import ModelSensor

    monkeypatch.setattr(frames, "_sensors", lambda: (Blind(), ModelSensor()))
    (job,) = rtl_jobs(SWEEPS["noise"], (3,), 1, 1, seed=1)
    names = check_frames(**job.arguments)
    assert names == [["markers"]]
    (unequal,) = rtl_summary([job], [names], 1)["unequal"]
    assert unequal["seed"] == 0 and unequal["differences"] == ["markers"]


class Blind:
    """A sensor that finds everything but markers."""

    def run(self, frames, settings):
        import dataclasses

        from sim.models.sensor import ModelSensor

        return [dataclasses.replace(one, markers=one.markers[:0]) for one in ModelSensor().run(frames, settings)]
