#!/usr/bin/env python3
"""Builds and verifies every valid model of the test data, against the counts of stats.json.

    tests/tools/dataset_test.py PAGODA DATA [PART_OF_NAME...]

For each file outside malformed/: triangles in the leaves + dropped = `tris`, which an independent
reader counted, and `pagoda verify` finds the database sound. Files without triangles are refused as
such. Models above 2M triangles run only with PAGODA_NIGHTLY set. Exit code 0, 1, or 77: skipped."""
import concurrent.futures
import json
import os
import sys
from pathlib import Path

sys.dont_write_bytecode = True  # no files in the source tree
sys.path.insert(0, str(Path(__file__).parent))
import program

BIG_TRIANGLES = 2_000_000
# Where we count otherwise than stats.json, and why we are right.
COUNTED_OTHERWISE = {
    "zoo/ply/fuze_ascii.ply": (
        1000, "stats.json reads the text as one stream of words, and its vertex lines hold more values than "
        "the header names: by lines, as ASCII PLY is written, there are the 1000 faces of fuze.obj"),
}
# Triangles, but no surface: what the refusal must say, and why.
WITHOUT_AREA = {
    "zoo/obj/number_formats.obj": (
        "no triangle of 1 can be used: 1 degenerate",
        "its one face, there to make it a model, has three corners on one line"),
}


def expected(name, counts):
    return COUNTED_OTHERWISE[name][0] if name in COUNTED_OTHERWISE else counts["tris"]


def refusal_problem(pagoda, path, folder, reason):
    run = pagoda.run("--quiet", "build", path, "-o", folder / "out.pagoda")
    if not program.is_one_error_line(run):
        return f"is not refused by one line: exit code {run.code}, {run.err!r}"
    if reason not in run.err or str(path) not in run.err:
        return f"is refused, but not for this: {reason}: {run.err.strip()}"
    if folder.names():
        return f"leaves {folder.names()}"
    return None


def build_problem(pagoda, path, folder, triangles):
    target, report = folder / "out.pagoda", folder / "report.json"
    run = pagoda.run("--quiet", "build", path, "-o", target, "--report", report)
    if run.code != 0 or run.err:
        return f"exit code {run.code}: {run.err.strip()}"
    if folder.names() != ["out.pagoda", "report.json"]:
        return f"leaves {folder.names()}"
    info = json.loads(pagoda.run("--quiet", "info", target, "--json").out)
    dropped = sum(info["dropped"].values())
    if info["triangles"] + dropped != triangles:
        return f"{info['triangles']} triangles + {dropped} dropped, not {triangles}"
    told = json.loads(report.read_text())
    for key in ("triangles", "triangles_in", "dropped", "nodes", "leaves"):
        if told[key] != info[key]:
            return f"the report says {key} {told[key]}, the database {info[key]}"
    run = pagoda.run("--quiet", "verify", target)
    return None if run.code == 0 else f"verify: {run.err.strip()} {run.out.strip()}"


def check(pagoda, data, name, counts):
    triangles = expected(name, counts)
    with program.Folder() as folder:
        if name in WITHOUT_AREA:
            return refusal_problem(pagoda, data / name, folder, WITHOUT_AREA[name][0])
        if triangles == 0:
            return refusal_problem(pagoda, data / name, folder, "no triangles")
        return build_problem(pagoda, data / name, folder, triangles)


def main():
    pagoda, data = program.Program(sys.argv[1]), Path(sys.argv[2])
    models = {name: counts for name, counts in program.counted_models(data).items()
              if not name.startswith("malformed/")
              and (not sys.argv[3:] or any(part in name for part in sys.argv[3:]))}
    for name in COUNTED_OTHERWISE.keys() & models.keys():
        if models[name]["tris"] == COUNTED_OTHERWISE[name][0]:
            print(f"{name}: stats.json agrees now; take the exception away")
            return 1
    if not os.environ.get("PAGODA_NIGHTLY"):
        for name in [n for n, c in models.items() if c["tris"] > BIG_TRIANGLES]:
            print(f"SKIPPED {name}: {models.pop(name)['tris']:,} triangles; set PAGODA_NIGHTLY to build it")
    problems = 0
    # Big ones first and two at a time: small models leave one core idle.
    order = sorted(models, key=lambda name: -models[name]["tris"])
    with concurrent.futures.ThreadPoolExecutor(2) as workers:
        for name, problem in zip(order, workers.map(lambda n: check(pagoda, data, n, models[n]), order)):
            if problem:
                problems += 1
                print(f"{name}: {problem}", flush=True)
    empty = sum(1 for name in models if expected(name, models[name]) == 0 or name in WITHOUT_AREA)
    print(f"{len(models) - empty} models built and verified, {empty} refused for having no surface, "
          f"{problems} of them not as they should")
    return 1 if problems or not models else 0


if __name__ == "__main__":
    sys.exit(main())
