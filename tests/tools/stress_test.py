#!/usr/bin/env python3
"""`pagoda stress` from a script: every workload on every disk, the keys that scripts rely on, counts
that add up, budgets that hold, and the report.

    tests/tools/stress_test.py PAGODA [UNITTEST OPTION...]

On a small interior that `pagoda generate` makes, drawn by whatever GL there is."""
import csv
import json
import os
import shutil
import sys
import unittest
from pathlib import Path

sys.dont_write_bytecode = True  # no files in the source tree
sys.path.insert(0, str(Path(__file__).parent))
import program
from page import Page

PAGODA = program.Program(sys.argv[1])
WORKLOADS = ["orbit", "flythrough", "zigzag", "teleport", "thrash"]
DISKS = ["as is", "500 MB/s", "100 MB/s, 10 ms", "50 Mbit/s, 40 ms", "1% of reads fail", "short reads"]
FRAMES = 12
SPREADS = ["frame_ms", "cpu_ms"]
# What depends on the scenario alone, not on the machine.
COUNTED = ["frames", "budgets", "missing_detail", "missing_pages", "empty_frames", "coarser_pixels",
           "time_to_sharp", "bytes", "reads", "evicted_pages", "peaks", "effective_tau", "jumps"]


class StressTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = folder = program.Folder()
        cls.addClassCleanup(folder.__exit__)
        for words in (["generate", "interior", "--triangles", 60000, "-o", folder / "i.glb"],
                      ["build", folder / "i.glb", "-o", folder / "i.pagoda", "--up", "z"]):
            run = PAGODA.run("-q", *words)
            assert run.code == 0, run.err
        run = cls.stress("--json", folder / "r.json", "--csv", folder / "r.csv",
                         "--html", folder / "r.html")
        assert run.code == 0, run.err
        cls.report = json.loads((folder / "r.json").read_text())
        cls.cells = cls.report["cells"]

    @classmethod
    def stress(cls, *words, **popen):
        return PAGODA.run("-q", "stress", cls.folder / "i.pagoda", "--size", "96x64",
                          "--frames", FRAMES, *words, **popen)

    def streaming(self):
        return [cell for cell in self.cells if not cell["is_resident"]]

    def test_every_workload_runs_on_every_disk_and_once_resident(self):
        self.assertEqual([(cell["workload"], cell["disk"]) for cell in self.cells],
                         [(workload, disk) for workload in WORKLOADS
                          for disk in ["all resident", *DISKS]])
        for cell in self.cells:
            self.assertEqual(cell["frames"], FRAMES)
            for key in SPREADS:
                spread = [cell[key][of] for of in ("median", "p95", "p99", "max")]
                self.assertEqual(spread, sorted(spread))
                self.assertGreater(spread[0], 0)
            for key in COUNTED + ["hitches", "p99_over_resident", "faults"]:
                self.assertIn(key, cell)
            for series in cell["series"].values():
                self.assertEqual(len(series), FRAMES)

    def test_bytes_read_are_the_sum_of_what_they_were_read_for(self):
        for cell in self.cells:
            parts = dict(cell["bytes"])
            self.assertEqual(parts.pop("read"), sum(parts.values()))
            self.assertGreater(parts["drawn"], 0)
            self.assertEqual(parts["twice"], 0 if cell["workload"] != "thrash" else parts["twice"])

    def test_no_budget_is_ever_passed(self):
        for cell in self.streaming():
            self.assertEqual(cell["peaks"]["frames_over_budget"], 0)
            for kind in ("gpu", "host"):
                self.assertLessEqual(cell["peaks"][f"{kind}_bytes"], cell["budgets"][f"{kind}_bytes"])
                self.assertGreater(cell["peaks"][f"{kind}_bytes"], 0)

    def test_an_upload_budget_is_kept_but_for_a_page_that_goes_alone(self):
        budget = 32768
        run = self.stress("--workload", "teleport", "--disk", "as-is", "--upload-budget", budget,
                          "--json", self.folder / "u.json")
        self.assertEqual(run.code, 0, run.err)
        resident, cell = json.loads((self.folder / "u.json").read_text())["cells"]
        self.assertEqual((resident["is_resident"], cell["profile"]), (True, "as-is"))
        self.assertEqual(cell["peaks"]["frames_over_budget"], 0)
        self.assertLessEqual(cell["peaks"]["upload_bytes"], budget)
        self.assertGreater(cell["peaks"]["upload_bytes"] + cell["peaks"]["upload_bytes_of_one_page"], 0)

    def test_what_is_resident_misses_nothing(self):
        for cell in self.cells:
            if cell["is_resident"]:
                self.assertEqual(cell["missing_detail"]["pixel_seconds"], 0)
                self.assertEqual(cell["missing_pages"], 0)
                self.assertEqual(cell["p99_over_resident"], {"frame": 1, "cpu": 1})
            else:
                self.assertGreater(cell["missing_detail"]["pixel_seconds"], 0)  # it begins cold
            self.assertLessEqual(cell["missing_detail"]["pixel_seconds"],
                                 cell["missing_detail"]["covered_pixel_seconds"])

    def test_thrash_has_less_gpu_memory_than_it_needs_and_says_what_tau_became(self):
        for cell in self.streaming():
            if cell["workload"] == "thrash":
                floor = 1 << 20  # the least there is
                needed = cell["budgets"]["needed_gpu_bytes"]
                self.assertLessEqual(cell["budgets"]["gpu_bytes"], max(floor, needed / 20 + 1))
            tau = cell["effective_tau"]
            self.assertLessEqual(tau["least"], tau["mean"])
            self.assertLessEqual(tau["mean"], tau["greatest"])

    def test_jumps_are_those_of_the_teleports(self):
        for cell in self.cells:
            frames = [jump["frame"] for jump in cell["jumps"]]
            self.assertEqual(frames, [0, 3, 6, 9] if cell["workload"] == "teleport" else [])
            sharp = [jump["sharp_s"] for jump in cell["jumps"] if jump["is_sharp"]]
            self.assertEqual(cell["time_to_sharp"]["sharp"], len(sharp))
            if sharp:
                self.assertAlmostEqual(cell["time_to_sharp"]["max_s"], max(sharp))

    def test_reads_fail_where_they_are_told_to_and_are_tried_again(self):
        run = self.stress("--workload", "flythrough", "--disk", "500MB/s,fail=50%", "--disk",
                          "500MB/s,5ms,short=50%", "--no-resident", "--json", self.folder / "f.json")
        self.assertEqual(run.code, 0, run.err)
        failing, short = json.loads((self.folder / "f.json").read_text())["cells"]
        self.assertGreater(failing["reads"]["failed"], 0)
        self.assertGreater(failing["reads"]["retries"], 0)
        self.assertGreater(short["reads"]["short"], 0)
        self.assertEqual(short["reads"]["failed"], 0)

    def test_the_same_seed_counts_the_same(self):
        words = ["--workload", "zigzag,teleport", "--disk", "20MB/s,8ms,fail=10%"]
        runs = []
        for name in ("a.json", "b.json"):
            self.assertEqual(self.stress(*words, "--json", self.folder / name).code, 0)
            runs.append(json.loads((self.folder / name).read_text())["cells"])
        for first, second in zip(*runs):
            for key in COUNTED:
                self.assertEqual(first[key], second[key], (first["workload"], key))
            for key in ("missing_share", "effective_tau"):
                self.assertEqual(first["series"][key], second["series"][key])

    def test_csv_has_a_line_a_cell(self):
        with open(self.folder / "r.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["disk"] for row in rows], ["all resident", *DISKS] * len(WORKLOADS))
        self.assertEqual(int(rows[1]["bytes/read"]), self.cells[1]["bytes"]["read"])

    @unittest.skipUnless(shutil.which("gnuplot"), "SKIPPED: no gnuplot; install gnuplot-nox")
    def test_the_report_is_one_sound_page_with_its_figures(self):
        text = (self.folder / "r.html").read_text()
        page = Page(text)
        self.assertEqual(page.faults, [])
        self.assertEqual(len(page.ids), len(set(page.ids)), "ids twice")
        self.assertEqual([link for link in page.links if not link.startswith("#")], [])
        self.assertEqual(page.counts["svg"], 5)
        self.assertNotIn("script", page.counts)
        for answer in ("Where does it hitch?", "Where is detail missing?", "Is a budget ever passed?",
                       "1% of reads fail"):
            self.assertIn(answer, text)
        self.assertLess(len(text), 600_000)

    def test_a_report_that_cannot_be_written_is_refused_before_the_work(self):
        for option in ("--json", "--csv", "--html"):
            for target in (self.folder / "none" / "r", self.folder.path):
                run = self.stress(option, target, timeout=20)
                self.assertTrue(program.is_one_error_line(run), run)
                self.assertIn(str(target), run.err)
                self.assertEqual(run.out, "")

    def test_wrong_usage_exits_2_and_a_bad_disk_or_database_1(self):
        for words in (["--workload", "spin"], ["--frames", 0], ["--size", "64"], ["--gpu-budget", "x"],
                      ["--strategy", "none"], ["--nothing"]):
            self.assertEqual(self.stress(*words).code, 2, words)
        self.assertTrue(program.is_one_error_line(self.stress("--disk", "fast")))
        self.assertTrue(program.is_one_error_line(PAGODA.run("stress", self.folder / "none.pagoda")))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
