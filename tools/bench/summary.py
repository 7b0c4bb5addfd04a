#!/usr/bin/env python3
"""All R.json of a folder as one Markdown table, for tools/bench.sh.

    tools/bench/summary.py FOLDER >summary.md

Ratios are CPU time of frustum, and of bool, over that of the row's strategy, with their intervals of
95%. docs/bench.md says what the numbers mean."""
import json
import sys
from pathlib import Path

EQUAL_DB = 99
KEY = ("path", "tau", "width", "height", "query_latency")
COLUMNS = ["strategy", "tau", "size", "latency", "nodes", "k tri.", "queries", "RARN / drawn, %",
           "delayed / drawn, %", "wrong px", "holes", "coarser px", "PSNR Y, dB", "CPU ms median", "p95", "frustum /", "hardest",
           "bool /", "read / exact"]


def ratio(report, run, numerator, frames):
    """`numerator`'s CPU time over the run's, as "2.31 [2.28, 2.35]"; empty where not measured."""
    for row in report["ratios"]:
        if (row["numerator"], row["denominator"], row["frames"]) == (numerator, run["strategy"], frames) \
                and all(row[key] == run[key] for key in KEY):
            return f"{row['ratio']:.2f} [{row['low']:.2f}, {row['high']:.2f}]"
    return ""


def share(part, whole):
    return f"{100 * part / whole:.2f}" if whole else ""


def row(report, run):
    compared = run["truth_frames"] > 0
    psnr = "equal" if run["psnr_luma"] >= EQUAL_DB else f"{run['psnr_luma']:.1f}"
    exact = run["bytes_exact"]
    return [run["strategy"], f"{run['tau']:g}", f"{run['width']}x{run['height']}", run["query_latency"],
            f"{run['drawn_nodes']:.1f}", f"{run['drawn_triangles'] / 1000:.1f}", f"{run['queries']:.1f}",
            share(run["rarn"], run["drawn_nodes"]), share(run["delayed"], run["drawn_nodes"]),
            f"{run['wrong_pixels']:g}" if compared else "", holes(run), coarser(run), psnr if compared else "",
            f"{run['cpu_ms']['median']:.2f}", f"{run['cpu_ms']['p95']:.2f}",
            ratio(report, run, "frustum", "all"), ratio(report, run, "frustum", "hardest"),
            ratio(report, run, "bool", "all"),
            f"{run['bytes_read'] / exact:.2f}" if exact else ""]


def holes(run):
    """Of frames that were held against the leaves, live ones too; empty where none were."""
    passes = [part for part in (run, run.get("live", {})) if part.get("reference_frames")]
    return sum(part.get("holes", 0) for part in passes) if passes else ""


def coarser(run):
    still = run.get("still", {})
    return still["coarser_pixels"] if still.get("frames") else ""


def line(cells):
    return "| " + " | ".join(map(str, cells)) + " |"


def main(folder):
    reports = {path.stem: json.loads(path.read_text()) for path in sorted(Path(folder).glob("*.json"))}
    print("# Error against run time\n")
    print("By `tools/bench.sh`; each run's own command and figures are in its page. Means a frame, medians of\n"
          "CPU time of all threads. The columns ending in / are CPU time of that strategy over the row's, hardest\n"
          "that of frustum over its slowest tenth of frames; intervals of 95%. Equal: no pixel of any frame differs\n"
          "from the cut at tau without culling. Holes and coarser px: totals, where counted. What the numbers mean:\n"
          "docs/bench.md.\n")
    for name, report in reports.items():
        model, machine = report["model"], report["machine"]
        print(f"## {name}\n")
        print(f"[Page]({name}.html). {report['database']}: {model['triangles']:,} triangles, {model['nodes']:,} nodes, "
              f"{model['bytes'] / 1e6:.1f} MB. {report['runs'][0]['frames']} frames, "
              f"{report['settings']['repeats']} timed passes. {machine['cores']} cores; {machine['device']}.\n")
        print(f"`{report['command']}`\n")
        print(line(COLUMNS))
        print("|" + "---|" * len(COLUMNS))
        for run in report["runs"]:
            print(line(row(report, run)))
        print()
        for fault in sorted({fault for run in report["runs"] for fault in run["faults"]}):
            print(f"Fault: {fault}\n")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
