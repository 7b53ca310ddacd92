#!/bin/bash
# What many runs cost beside their simulation, and what becomes of 10^5 runs on 10^3 cores. Terms are measured by sweeps
# of a pendulum whose runs take next to no time; a larger sweep is then predicted and measured, and the last lines are
# 10^5 runs on paper.
#   tests/cluster/farm_cost.sh ROOT
# Needs ROOT/build with what `tumble sweep` needs, and python3; with Open MPI its ranks are measured too. A minute.
set -euo pipefail
root=$(realpath "$1")
TUMBLE_ROOT=$root exec python3 - "$root/build/bin/tumble" <<'PY'
import os, resource, shutil, subprocess, sys, tempfile, time

tumble, folder = sys.argv[1], tempfile.mkdtemp(prefix="farm_cost.")


def sweep(points, *words, fresh=True):
    """CPU of the command and all that it starts, time by the clock [s]."""
    if fresh:
        shutil.rmtree(f"{folder}/out", ignore_errors=True)
    began, before = time.time(), resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([tumble, "sweep", "double_pendulum", "--over", f"gravity=1:{points}:1", "--duration-s", "0.01",
                    "--modules", "reference", "--out", f"{folder}/out", *words],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, time.time() - began


def size(path):
    return sum(os.path.getsize(os.path.join(where, name)) for where, _, names in os.walk(path) for name in names)


def bytes_now():
    out = f"{folder}/out/double_pendulum"
    return size(f"{out}/points"), size(out) - size(f"{out}/points")


def line(few, many, small=100, large=400):
    """A start and what each point adds."""
    each = (many - few) / (large - small)
    return few - small * each, each


def best(*of):
    return min((sweep(*of) for _ in range(3)), key=lambda it: it[0])


try:
    made_100, kept_100 = best(100, "--jobs", "1"), bytes_now()
    made_400, kept_400 = best(400, "--jobs", "1"), bytes_now()
    merge_400 = min(sweep(400, "--jobs", "1", fresh=False)[0] for _ in range(3))
    sweep(100, "--jobs", "1")
    merge_100 = min(sweep(100, "--jobs", "1", fresh=False)[0] for _ in range(3))
    start, point = line(made_100[0], made_400[0])
    merge_start, merge = line(merge_100, merge_400)
    part, tables = line(kept_100[0], kept_400[0])[1], line(kept_100[1], kept_400[1])[1]
    shard = best(400, "--jobs", "1", "--shard", "1/400")[0]  # a task with one point
    print(f"a command           {1e3 * start:8.1f} ms of CPU")
    print(f"a point, its process and its 0.01 s of motion {1e3 * point:6.2f} ms of CPU")
    print(f"a point read again and laid into the tables   {1e3 * merge:6.3f} ms of CPU")
    print(f"a task of one point {1e3 * shard:8.1f} ms of CPU")
    print(f"a point's file      {part:8.0f} bytes, its part of tables and page {tables:.0f} bytes")
    if shutil.which("mpirun"):
        ranks = ["--on", "mpi", "--shards", "2"]
        few, many = best(100, *ranks)[0], best(400, *ranks)[0]
        begin, each = line(few, many)
        print(f"two ranks of MPI    {1e3 * begin:8.1f} ms of CPU to begin, {1e3 * each:.2f} ms a point")
    predicted, measured = start + 2000 * point, sweep(2000, "--jobs", "1")[0]
    print(f"2,000 points: predicted {predicted:.2f} s, measured {measured:.2f} s of CPU "
          f"({100 * (predicted / measured - 1):+.0f} %)")
    print("\n10^5 runs on 10^3 cores in 1,000 tasks of 100, on paper:")
    print(f"  written {1e5 * part / 1e6:.0f} MB in 10^5 files, read once by the command that merges, which writes "
          f"{1e5 * tables / 1e6:.0f} MB in {merge_start + 1e5 * merge:.0f} s")
    for run in (0.01, 0.1, 1.0, 10.0):
        task = shard + 99 * point + 100 * run
        whole = task + merge_start + 1e5 * merge
        print(f"  runs of {run:5g} s: {task:8.1f} s a task, {whole:8.1f} s in all: {1e5 * run / whole:5.0f} of 1,000 "
              f"cores' worth, scheduling {100 * (1 - 100 * run / task):.1f} %")
finally:
    shutil.rmtree(folder)
PY
