#!/usr/bin/env python3
"""What the run time set out to reach, against the R.json of a folder, as one Markdown table.

    tools/bench/targets.py FOLDER

Each row shows all scenes of its class and is judged by the worst of them. A ratio of times is met
when its interval of 95% reaches the target and none of it lies more than 5% below. docs/bench.md
says what the numbers mean; tools/bench.sh makes the folder."""
import json
import sys
from pathlib import Path

DEEP = ["plant-walk", "interior-walk"]
CENTRE = DEEP + ["lego-show-a-walk"]
INSIDE = CENTRE + ["hospital-walk", "clinic-walk", "city-walk"]
CONSERVATIVE = {"bool", "sw", "coh", "hzb", "late", "slabs"}


class Folder:
    def __init__(self, folder):
        self.reports = {path.stem: json.loads(path.read_text()) for path in sorted(Path(folder).glob("*.json"))}

    def run(self, name, strategy):
        runs = self.reports.get(name, {"runs": []})["runs"]
        return next((run for run in runs if run["strategy"] == strategy), None)

    def beside_frustum(self, names):
        """`names`, each by the run that has frustum in it: the centre has one of its own."""
        return [own if (own := f"{name}-frustum") in self.reports else name for name in names]

    def runs(self):
        return [(name, run) for name, report in self.reports.items() for run in report["runs"]]

    def ratio(self, name, numerator, denominator, frames="all"):
        for row in self.reports.get(name, {"ratios": []})["ratios"]:
            if (row["numerator"], row["denominator"], row["frames"]) == (numerator, denominator, frames):
                return row
        return None


class Table:
    def __init__(self):
        print("| what | target | measured | |\n|---|---|---|---|")

    def row(self, what, target, cells, verdicts):
        verdict = "not measured" if not cells else "met" if all(verdicts) else "missed"
        print(f"| {what} | {target} | {'; '.join(cells) or '-'} | {verdict} |")


def quotients(table, what, target, names, limit, quotient, text):
    """`quotient(name)` of each scene that was measured, at most `limit`."""
    values = [(name, quotient(name)) for name in names]
    values = [(name, value) for name, value in values if value is not None]
    table.row(what, target, [f"{name} {text.format(value)}" for name, value in values],
              [value <= limit for _, value in values])


def times(folder, table, what, target, names, limit, numerator, denominator, frames="all"):
    rows = [(name, folder.ratio(name, numerator, denominator, frames)) for name in names]
    rows = [(name, row) for name, row in rows if row]
    table.row(what, target, [f"{name} {row['ratio']:.2f} [{row['low']:.2f}, {row['high']:.2f}]" for name, row in rows],
              [row["high"] >= limit and row["low"] >= 0.95 * limit for _, row in rows])


def of_runs(folder, key_a, run_a, key_b, run_b):
    """A function of a report's name: `key_a` of strategy `run_a` over `key_b` of `run_b`."""
    def quotient(name):
        a, b = folder.run(name, run_a), folder.run(name, run_b)
        return a[key_a] / b[key_b] if a and b and b[key_b] else None
    return quotient


def best_against_auto(folder, table):
    cells, verdicts = [], []
    for name, report in folder.reports.items():
        if folder.run(name, "auto") is None or len(report["runs"]) < 3 or f"{name}-auto" in folder.reports:
            continue
        others = [run for run in report["runs"] if run["strategy"] != "auto"]
        best = min(others, key=lambda run: run["cpu_ms"]["mean"])["strategy"]
        row = folder.ratio(name, best, "auto")
        if row is None:
            continue
        cells.append(f"{name} {best} {row['ratio']:.2f} [{row['low']:.2f}, {row['high']:.2f}]")
        verdicts.append(row["high"] >= 0.95 and row["low"] >= 0.95 * 0.95)
    table.row("CPU time, best strategy / `auto`", ">= 0.95", cells, verdicts)


def wrong_pixels(folder, table):
    compared = [(name, run) for name, run in folder.runs()
                if run["strategy"] in CONSERVATIVE and run["truth_frames"] > 0]
    latencies = sorted({run["query_latency"] for _, run in compared})
    cells = []
    for latency in latencies:
        runs = [run for _, run in compared if run["query_latency"] == latency]
        frames = sum(run["truth_frames"] for run in runs)
        cells.append(f"latency {latency}: {sum(r['wrong_pixels'] * r['truth_frames'] for r in runs):g} in {frames} frames")
    table.row("wrong pixels, " + ", ".join(sorted(CONSERVATIVE)), "0", cells,
              [run["wrong_pixels"] == 0 for _, run in compared])


def fallback(folder, table):
    cells, verdicts = [], []
    for name, run in folder.runs():
        if name.endswith("-walk-disk500") and run["live"]["frames"]:
            share = run["live"]["fallback_share"]
            cells.append(f"{name.removesuffix('-disk500')} {100 * share:.2f}%")
            verdicts.append(share <= 0.005)
    table.row("fallback pixels live, 500 MB/s, prefetch on", "<= 0.5%", cells, verdicts)


def main(source):
    folder, table = Folder(source), Table()
    quotients(table, "drawn nodes, `coh` / `sw`", "<= 1.01", CENTRE, 1.01,
              of_runs(folder, "drawn_nodes", "coh", "drawn_nodes", "sw"), "{:.3f}")
    quotients(table, "RARN / drawn, `coh`", "<= 0.15%", CENTRE, 0.0015,
              of_runs(folder, "rarn", "coh", "drawn_nodes", "coh"), "{:.2%}")
    quotients(table, "delayed / drawn, `coh`", "<= 3%", CENTRE, 0.03,
              of_runs(folder, "delayed", "coh", "drawn_nodes", "coh"), "{:.2%}")
    quotients(table, "drawn nodes, `coh` / `bool`", "<= 0.70", DEEP, 0.70,
              of_runs(folder, "drawn_nodes", "coh", "drawn_nodes", "bool"), "{:.2f}")
    times(folder, table, "CPU time, `bool` / `coh`", ">= 1.3", DEEP, 1.3, "bool", "coh")
    times(folder, table, "CPU time, `simp` / `coh`", ">= 1.1", DEEP, 1.1, "simp", "coh")
    times(folder, table, "the same cuts in a sixteenth of the pixels, `bool` / `coh`", "(1.3)",
          [f"{name}-pixels" for name in DEEP], 1.3, "bool", "coh")
    times(folder, table, "the same cuts in a sixteenth of the pixels, `simp` / `coh`", "(1.1)",
          [f"{name}-pixels" for name in DEEP], 1.1, "simp", "coh")
    cells = [(name, folder.run(name, "coh")) for name in CENTRE]
    cells = [(name, run) for name, run in cells if run]
    table.row("PSNR luma, `coh` against `bool`, mean (worst frame)", ">= 35.5 dB",
              [f"{name} {run['psnr_luma']:.1f} ({run['psnr_luma_worst']:.1f})" for name, run in cells],
              [run["psnr_luma"] >= 35.5 for _, run in cells])
    times(folder, table, "CPU time, `frustum` / `coh`, inside", ">= 2.5", folder.beside_frustum(INSIDE), 2.5, "frustum", "coh")
    times(folder, table, "the same, hardest frames", ">= 6", folder.beside_frustum(INSIDE), 6, "frustum", "coh", "hardest")
    times(folder, table, "no occlusion, `frustum` / `auto`", ">= 0.97", ["torus-fly", "torus-orbit"], 0.97,
          "frustum", "auto")
    quotients(table, "bytes read / exact, settled, prefetch off", "<= 1.4", CENTRE, 1.4,
              of_runs(folder, "bytes_read", "coh", "bytes_exact", "coh"), "{:.2f}")
    quotients(table, "bytes read / exact, settled, prefetch on", "<= 1.7",
              [f"{name}-prefetch" for name in CENTRE], 1.7,
              of_runs(folder, "bytes_read", "coh", "bytes_exact", "coh"), "{:.2f}")
    fallback(folder, table)
    quotients(table, "bytes read, `coh` / `frustum`, inside", "<= 0.5",
              folder.beside_frustum(INSIDE), 0.5,
              of_runs(folder, "bytes_read", "coh", "bytes_read", "frustum"), "{:.2f}")
    best_against_auto(folder, table)
    wrong_pixels(folder, table)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
