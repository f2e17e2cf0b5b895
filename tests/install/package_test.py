#!/usr/bin/python3
"""The Debian packages hold what they should, name what they need, and work from an empty folder.
usage: package_test.py CPACK BUILD_FOLDER FOLDER; leaves the packages in FOLDER; exit code 77 without dpkg"""
import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

from installation import Installation, run, skip

CPACK, BUILD, WORK = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
# Only a build with the prefix /usr (scripts/package) installs into the folder of its architecture.
LINTIAN_ACCEPTS = ["pkg-config-multi-arch-wrong-dir", "pkg-config-unavailable-for-cross-compilation"]


def fields_of(package):
    text = re.sub(r"\n ", " ", run("dpkg-deb", "-f", package))
    return dict(line.split(": ", 1) for line in text.splitlines() if ": " in line)


class Packages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(WORK, ignore_errors=True)
        run(CPACK, "--config", BUILD / "CPackConfig.cmake", "-B", WORK, "-D", "CPACK_DEBIAN_COMPRESSION_TYPE=gzip",
            cwd=BUILD)  # faster than xz
        shutil.rmtree(WORK / "_CPack_Packages")
        cls.packages = {path.name.split("_")[0]: path for path in WORK.glob("*.deb")}
        for package in cls.packages.values():
            run("dpkg-deb", "-x", package, WORK / "unpacked")
        cls.installed = Installation(WORK / "unpacked/usr", WORK / "run")

    def test_fields(self):
        version = re.search(r'CPACK_PACKAGE_VERSION "(.*)"', (BUILD / "CPackConfig.cmake").read_text())[1]
        for name, package in self.packages.items():
            fields = fields_of(package)
            self.assertEqual((fields["Package"], fields["Version"]), (name, version))
            for field in ("Architecture", "Depends", "Description", "Maintainer", "Section", "Installed-Size"):
                self.assertIn(field, fields, name)
        programs = fields_of(self.packages["iga-trimmed-solids"])
        for library in ("libc6", "libhdf5-103-1", "libcholmod3", "libtbb12", "python3-h5py"):
            self.assertRegex(programs["Depends"], rf"\b{library}\b")
        self.assertNotIn("libocct", programs["Depends"])
        if "iga-trimmed-solids-cad" in self.packages:
            self.assertIn("libocct-data-exchange", fields_of(self.packages["iga-trimmed-solids-cad"])["Depends"])
            self.assertIn("iga-trimmed-solids-cad", programs["Recommends"])

    def test_programs_are_stripped_and_pages_are_there(self):
        for program in ("igaprep", "igasolve"):
            sections = run("readelf", "-S", "-W", self.installed.prefix / "bin" / program)
            self.assertNotIn(".symtab", sections)
            self.assertNotIn(".debug_info", sections)
        for program in (self.installed.prefix / "bin").iterdir():
            self.assertTrue((self.installed.prefix / f"share/man/man1/{program.name}.1.gz").exists(), program.name)

    def test_programs_run_from_there(self):
        report = self.installed.prepare("10_aligned_box", "aligned_box.h5")
        self.assertEqual(report["bodies"], 1)
        self.assertEqual(len(self.installed.modes()["frequencies"]), 1)

    def test_python_finds_the_package(self):
        link = self.installed.prefix / "lib/python3/dist-packages/igatools"
        self.assertTrue(link.is_symlink() and not link.readlink().is_absolute())
        env = {**self.installed.env, "PYTHONPATH": str(link.parent)}
        run(sys.executable, "-c", "from igatools import iga_results", env=env, cwd="/")

    @unittest.skipUnless(shutil.which("lintian"), "lintian is missing")
    def test_lintian(self):
        found = subprocess.run(["lintian", "--allow-root", "--no-cfg", "--suppress-tags", ",".join(LINTIAN_ACCEPTS),
                                *self.packages.values()], capture_output=True, text=True)
        self.assertEqual(re.findall(r"^[EW]: .*", found.stdout, re.MULTILINE), [], found.stderr)


if __name__ == "__main__":
    missing = [tool for tool in ("dpkg-deb", "dpkg-shlibdeps") if not shutil.which(tool)]
    if missing:
        skip(f"{', '.join(missing)} is missing; apt-get install dpkg-dev")
    unittest.main(argv=sys.argv[:1])
