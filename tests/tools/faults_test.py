#!/usr/bin/env python3
"""`pagoda build` from a script: what it takes, what it refuses, and what a fault leaves behind.

    tests/tools/faults_test.py PAGODA [UNITTEST OPTION...]

Faults at a chosen place inside a build are in tests/hlod/build/faults_test.cpp. Here: several inputs in
one database, foreign kinds, targets and disks that cannot be written, signals. Full disks need a small
tmpfs: as root; skipped, and said so, where mounting is not allowed. Models are made by `pagoda generate`."""
import fcntl
import json
import os
import resource
import signal
import subprocess
import sys
import termios
import time
import unittest
from pathlib import Path

sys.dont_write_bytecode = True  # no files in the source tree
sys.path.insert(0, str(Path(__file__).parent))
import program

PAGODA = program.Program(sys.argv[1])

# A right triangle in the plane z = 0 with legs of 1 along x and y.
TRIANGLE_OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
TRIANGLE_OFF = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
TRIANGLE_STL = ("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                "endloop\nendfacet\nendsolid a\n")


class FaultTest(unittest.TestCase):
    def setUp(self):
        self.folder = program.Folder()
        self.addCleanup(self.folder.__exit__)

    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    def torus(self, triangles, name="torus.ply"):
        path = self.folder / name
        run = PAGODA.run("-q", "generate", "torus", "--triangles", triangles, "-o", path)
        self.assertEqual(run.code, 0, run.err)
        return path

    def build(self, *arguments, **popen):
        return PAGODA.run("-q", "build", *arguments, **popen)

    def built(self, *arguments):
        target = self.folder / "out.pagoda"
        run = self.build(*arguments, "-o", target)
        self.assertEqual((run.code, run.err), (0, ""))
        self.assertEqual(PAGODA.run("-q", "verify", target).code, 0)
        return json.loads(PAGODA.run("-q", "info", target, "--json").out)

    def refused(self, run, *words):
        self.assertTrue(program.is_one_error_line(run), f"exit code {run.code}: {run.err!r}")
        for word in words:
            self.assertIn(str(word), run.err)

    def near(self, box, low, high):
        for found, wanted in zip(box["min"] + box["max"], low + high):
            self.assertAlmostEqual(found, wanted, places=4)


class Inputs(FaultTest):
    def test_files_folders_and_globs_become_one_database(self):
        single = self.write("single.obj", TRIANGLE_OBJ)
        self.write("parts/a.off", TRIANGLE_OFF)
        self.write("parts/deep/b.stl", TRIANGLE_STL)
        self.write("parts/readme.txt", "not a model")
        self.write("more/c1.obj", TRIANGLE_OBJ)
        self.write("more/c2.obj", TRIANGLE_OBJ)
        self.write("more/d1.obj", TRIANGLE_OBJ)
        info = self.built(single, self.folder / "parts", f"{self.folder.path}/more/c*.obj")
        self.assertEqual(sorted(s["path"] for s in info["sources"]),
                         ["a.off", "b.stl", "c1.obj", "c2.obj", "single.obj"])
        self.assertEqual(info["triangles"], 5)

    def test_each_input_has_its_own_unit_axis_and_place(self):
        first = self.write("a.obj", TRIANGLE_OBJ)
        second = self.write("b.obj", TRIANGLE_OBJ)
        # Centimetres, turned from y up to z up, then moved.
        info = self.built(f"{first}@up=z", f"{second}@up=y,unit=cm,move=10:20:30")
        self.assertEqual(info["up"], "z")
        self.near(info["box"], [0, 0, 0], [10.01, 20, 30.01])
        self.assertEqual([s["unit"] for s in info["sources"]], [1, 0.01])
        self.assertEqual([s["up"] for s in info["sources"]], ["z", "y"])

    def test_a_folder_gives_its_options_to_all_its_files(self):
        self.write("parts/a.obj", TRIANGLE_OBJ)
        self.write("parts/b.off", TRIANGLE_OFF)
        info = self.built(f"{self.folder / 'parts'}@unit=1000,move=5:0:0")
        self.near(info["box"], [5, 0, 0], [1005, 1000, 0])

    def test_a_matrix_may_mirror(self):
        path = self.write("a.obj", TRIANGLE_OBJ)
        info = self.built(f"{path}@matrix=-1:0:0:0:0:1:0:0:0:0:1:7:0:0:0:1")
        self.near(info["box"], [-1, 0, 7], [0, 1, 7])

    def test_wrong_options_name_the_input_and_what_may_be_written(self):
        path = self.write("a.obj", TRIANGLE_OBJ)
        for suffix in ("up=x", "unit=0", "unit=parsec", "move=1:2", "move=1:2:nan", "turn=3", "up=z,x"):
            with self.subTest(suffix):
                run = self.build(f"{path}@{suffix}", "-o", self.folder / "out.pagoda")
                self.refused(run, path, "INPUT@up=")
        self.assertEqual(self.folder.names(), ["a.obj"])

    def test_a_name_with_an_at_sign_is_a_name_first(self):
        path = self.write("model@up=y.obj", TRIANGLE_OBJ)
        self.assertEqual(self.built(path)["triangles"], 1)

    def test_other_kinds_name_a_converter(self):
        for name, tool in (("a.ifc", "IfcConvert"), ("a.STEP", "FreeCAD"), ("a.las", "CloudCompare"),
                           ("a.fbx", "Blender"), ("a.dwg", "CAD"), ("a.json", "cjio"), ("a.zip", "unpack")):
            with self.subTest(name):
                path = self.write(name, "anything")
                self.refused(self.build(path, "-o", self.folder / "out.pagoda"), path, tool)
                path.unlink()
        self.assertEqual(self.folder.names(), [])

    def test_what_is_missing_is_named(self):
        (self.folder / "empty").mkdir()
        target = self.folder / "out.pagoda"
        self.refused(self.build(self.folder / "no.ply", "-o", target), "no.ply", "no such file")
        self.refused(self.build(f"{self.folder / 'no.ply'}@up=z", "-o", target), "no.ply:", "no such file")
        self.refused(self.build(self.folder / "no*.ply", "-o", target), "no*.ply", "no such file")
        self.refused(self.build(self.folder / "empty", "-o", target), "empty", "no file of a known format")
        self.refused(self.build("/dev/null", "-o", target), "/dev/null")
        self.assertEqual(self.folder.names(), ["empty"])

    def test_one_broken_file_of_many_is_named_and_nothing_is_left(self):
        self.write("parts/a.obj", TRIANGLE_OBJ)
        broken = self.write("parts/b.off", TRIANGLE_OFF[:-4])
        self.refused(self.build(self.folder / "parts", "-o", self.folder / "out.pagoda"), broken, "line ")
        self.assertEqual(self.folder.names(), ["parts"])


class Targets(FaultTest):
    def test_an_existing_target_is_kept_without_force_and_by_a_build_that_fails(self):
        path, target = self.write("a.obj", TRIANGLE_OBJ), self.folder / "out.pagoda"
        broken = self.write("b.obj", "f 1 2 3\n")
        self.assertEqual(self.build(path, "-o", target).code, 0)
        before = target.read_bytes()
        self.refused(self.build(path, "-o", target), target, "--force")
        self.refused(self.build(broken, "-o", target, "--force"), broken)
        self.assertEqual(target.read_bytes(), before)
        self.assertEqual(self.build(path, "-o", target, "--force").code, 0)
        self.assertEqual(self.folder.names(), ["a.obj", "b.obj", "out.pagoda"])

    def test_targets_that_cannot_be_written_are_named(self):
        path, scratch = self.write("a.obj", TRIANGLE_OBJ), self.folder / "scratch"
        scratch.mkdir()
        for target in (self.folder / "no" / "out.pagoda", scratch, path / "out.pagoda", "/proc/out.pagoda"):
            with self.subTest(target):
                folder = Path(target).parent
                self.refused(self.build(path, "-o", target), folder)
                self.refused(self.build(path, "-o", target, "--scratch", scratch), folder)
        run = self.build(path, "-o", self.folder / "out.pagoda", "--scratch", self.folder / "no")
        self.refused(run, "no such folder")
        self.assertEqual(self.folder.names(), ["a.obj", "scratch"])
        self.assertEqual(os.listdir(scratch), [])

    @unittest.skipIf(os.geteuid() == 0, "SKIPPED: root may write anywhere")
    def test_a_folder_without_permission_is_named(self):
        path, locked = self.write("a.obj", TRIANGLE_OBJ), self.folder / "locked"
        locked.mkdir(mode=0o555)
        self.refused(self.build(path, "-o", locked / "out.pagoda"), locked, "permission")


class FullDisks(FaultTest):
    def small_disk(self):
        point = self.folder / "disk"
        point.mkdir()
        mount = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=256k", "tmpfs", str(point)],
                               capture_output=True)
        if mount.returncode != 0:
            self.skipTest("SKIPPED: a tmpfs may not be mounted here")
        self.addCleanup(subprocess.run, ["umount", str(point)], check=True)
        return point

    def test_a_full_target_disk_is_said_and_nothing_is_left(self):
        path, disk = self.torus(100_000), self.small_disk()
        scratch = self.folder / "scratch"
        scratch.mkdir()
        run = self.build(path, "-o", disk / "out.pagoda", "--scratch", scratch)
        self.refused(run, disk, "No space left", "another disk")
        self.assertEqual((os.listdir(disk), os.listdir(scratch)), ([], []))

    def test_a_full_scratch_disk_is_said_and_nothing_is_left(self):
        path, disk = self.torus(100_000), self.small_disk()
        run = self.build(path, "-o", self.folder / "out.pagoda", "--scratch", disk)
        self.refused(run, disk, "No space left", "--scratch")
        self.assertEqual(os.listdir(disk), [])
        self.assertEqual(self.folder.names(), ["disk", "torus.ply"])

    def test_a_limit_on_file_sizes_is_said_and_nothing_is_left(self):
        path = self.torus(100_000)

        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 20, 1 << 20))

        run = self.build(path, "-o", self.folder / "out.pagoda", preexec_fn=limit)
        self.refused(run, self.folder.path, "File too large", "ulimit")
        self.assertEqual(self.folder.names(), ["torus.ply"])


class Signals(FaultTest):
    """A pipe for standard error that has room for the first progress line but not for the second stops the
    build at a known place, after the survey, with scratch files open, however fast the machine is."""

    ROOM = 18  # "survey: 0.0 s" and its newline; "read and snap: 0.0 s" does not fit behind it

    def stopped_build(self):
        path = self.torus(20_000)
        reading, writing = os.pipe()
        self.addCleanup(os.close, reading)
        size = fcntl.fcntl(writing, fcntl.F_SETPIPE_SZ, 4096)
        os.write(writing, b"." * (size - self.ROOM))
        process = PAGODA.start("build", path, "-o", self.folder / "out.pagoda", stderr=writing)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        os.close(writing)
        filled = 0
        while filled == 0 and process.poll() is None:  # until it has said its first line
            waiting = fcntl.ioctl(reading, termios.FIONREAD, b"\0\0\0\0")
            filled = max(0, int.from_bytes(waiting, sys.byteorder) - (size - self.ROOM))
            time.sleep(0.001)
        self.assertIsNone(process.poll())
        return process, reading

    def drain(self, reading):
        text = b""
        while part := os.read(reading, 65536):
            text += part
        return text.decode().lstrip(".")

    def test_ctrl_c_ends_with_130_and_leaves_nothing(self):
        for kind in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(kind.name):
                process, reading = self.stopped_build()
                process.send_signal(kind)
                text = self.drain(reading)
                self.assertEqual(process.wait(), 130)
                self.assertTrue(text.endswith("pagoda: interrupted\n"), text)
                self.assertEqual(self.folder.names(), ["torus.ply"])
                (self.folder / "torus.ply").unlink()

    def test_kill_9_leaves_nothing_before_the_writing(self):
        process, _ = self.stopped_build()
        process.kill()
        self.assertEqual(process.wait(), -signal.SIGKILL)
        self.assertEqual(self.folder.names(), ["torus.ply"])

    def test_what_kill_9_left_is_said_and_removed_but_not_what_another_build_is_writing(self):
        path = self.write("a.obj", TRIANGLE_OBJ)
        self.write(".out.pagoda.part-4711", "half a database")
        self.write(".other.pagoda.part-4711", "of another target")
        busy = self.write(".out.pagoda.part-4712", "being written")
        with open(busy) as file:
            fcntl.flock(file, fcntl.LOCK_EX)  # as a living build holds it
            run = PAGODA.run("build", path, "-o", self.folder / "out.pagoda")
        self.assertEqual(run.code, 0, run.err)
        self.assertIn("an earlier build was cut off; removing .out.pagoda.part-4711", run.err)
        self.assertEqual(self.folder.names(),
                         [".other.pagoda.part-4711", ".out.pagoda.part-4712", "a.obj", "out.pagoda"])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v", *sys.argv[2:]])
