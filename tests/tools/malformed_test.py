#!/usr/bin/env python3
"""Gives every malformed file of the test data to `pagoda build`: refused by one line, or built sound.

    tests/tools/malformed_test.py PAGODA DATA [--page docs/malformed.md]

No crash, no hang (5 s), less than 1 GiB; refused means exit code 1, one line on stderr that names the
file and, where there is one, the place, and an empty folder; built means that `pagoda verify` finds the
database sound and triangles + dropped are all that came in. Side files (.bin) are given too. --page
writes the table of outcomes. Exit code 0, 1, or 77: skipped, no models."""
import argparse
import collections
import concurrent.futures
import json
import re
import sys
from pathlib import Path

sys.dont_write_bytecode = True  # no files in the source tree
sys.path.insert(0, str(Path(__file__).parent))
import program

SECONDS = 5
MEMORY_BYTES = 1 << 30
# A file as a whole is at fault here: no line, byte or field could be named.
PLACELESS = ("no triangles", "no triangle of", "files of kind", "no finite extent",
             "so far from the origin", "smaller than 2^-29")

Outcome = collections.namedtuple("Outcome", "name kind why problem peak_bytes")


def refusal(name, path, run, folder):
    problem = None
    text = run.err.strip()
    if run.code != 1 or not program.is_one_error_line(run):
        problem = f"exit code {run.code}: {text[-2000:]}"
    elif not text.startswith(f"pagoda: {path}:"):
        problem = f"does not name the file: {text}"
    elif folder.names():
        problem = f"leaves {folder.names()}"
    why = text.removeprefix(f"pagoda: {path}:").strip()
    hasPlace = re.match(r"[^ ][^:;]*: ", why) is not None
    if not problem and not hasPlace and not any(reason in why for reason in PLACELESS):
        problem = f"names no place: {text}"
    return Outcome(name, "refused", why, problem, run.peak_bytes)


def built(pagoda, name, run, folder):
    problem = None
    report = json.loads((folder / "report.json").read_text())
    dropped, ignored = report["dropped"], report["ignored"]
    if run.err:
        problem = f"says {run.err.strip()}"
    elif folder.names() != ["out.pagoda", "report.json"]:
        problem = f"leaves {folder.names()}"
    elif report["triangles"] + sum(dropped.values()) != report["triangles_in"]:
        problem = f"{report['triangles']} triangles and {dropped} dropped of {report['triangles_in']}"
    else:
        check = pagoda.run("--quiet", "verify", folder / "out.pagoda", timeout=SECONDS)
        if check.code != 0:
            problem = f"verify: {check.err.strip()} {check.out.strip()}"
    parts = [f"{report['triangles']} triangles"]
    parts += [f"dropped {count} ({reason})" for reason, count in dropped.items()]
    parts += [f"ignored {count} ({what})" for what, count in ignored.items()]
    return Outcome(name, "built", "; ".join(parts), problem, run.peak_bytes)


def outcome(pagoda, data, name):
    path = data / name
    with program.Folder() as folder:
        run = pagoda.run("--quiet", "build", path, "-o", folder / "out.pagoda", "--report",
                         folder / "report.json", "--threads", "2", timeout=SECONDS)
        result = built(pagoda, name, run, folder) if run.code == 0 else refusal(name, path, run, folder)
    if run.code is None:
        result = result._replace(problem=f"still at work after {SECONDS} s")
    if run.peak_bytes >= MEMORY_BYTES:
        result = result._replace(problem=f"took {run.peak_bytes >> 20} MiB")
    return result


def page(outcomes, totals):
    lines = [
        "# Malformed files: what becomes of each",
        "Every file under `malformed/` of the test data (fuzzers' findings and other projects' negative tests, side",
        "files too) given to `pagoda build`. *Refused*: exit code 1, one line on stderr, nothing left in the folder;",
        "the line follows without the path. *Built*: `pagoda verify` finds the database sound; what was dropped or",
        "ignored was counted. No crash, no hang (5 s), less than 1 GiB of memory each, under the address and",
        "undefined-behaviour sanitizers. Many of the glTF files are fragments whose meshes no scene shows: they are",
        "parsed and checked, but hold no surface.",
        "```",
        "cmake --preset asan -DPAGODA_VIEWER=OFF -DPAGODA_TESTS=OFF && cmake --build build-asan --target pagoda",
        "tests/tools/malformed_test.py build-asan/tools/pagoda ../shared/data --page docs/malformed.md",
        "```",
        f"{totals}.",
        "",
        "| file | outcome | why |",
        "|---|---|---|",
    ]
    for entry in outcomes:
        why = entry.why.replace("|", "\\|").replace("<", "&lt;")
        lines.append(f"| {entry.name.removeprefix('malformed/')} | {entry.kind} | {why} |")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("pagoda")
    parser.add_argument("data", type=Path)
    parser.add_argument("--page", type=Path)
    arguments = parser.parse_args()
    program.counted_models(arguments.data)  # skips without models
    names = sorted(str(path.relative_to(arguments.data))
                   for path in (arguments.data / "malformed").rglob("*") if path.is_file())
    pagoda = program.Program(arguments.pagoda)
    with concurrent.futures.ThreadPoolExecutor(2) as workers:
        outcomes = list(workers.map(lambda name: outcome(pagoda, arguments.data, name), names))
    problems = [entry for entry in outcomes if entry.problem]
    for entry in problems:
        print(f"{entry.name}: {entry.problem}")
    kinds = collections.Counter(entry.kind for entry in outcomes)
    highest = max(entry.peak_bytes for entry in outcomes)
    totals = f"{len(outcomes)} files: {kinds['refused']} refused, {kinds['built']} built"
    print(f"{totals}, {len(problems)} not as they should; at most {highest >> 20} MiB")
    if arguments.page:
        arguments.page.write_text(page(outcomes, totals))
    return 1 if problems or len(names) < 100 else 0


if __name__ == "__main__":
    sys.exit(main())
