#!/usr/bin/python3
"""The Debian packages install into a Debian 12 that holds nothing but its base, with all that they need, and work there.
usage: clean_root_test.py PACKAGES_FOLDER FOLDER
Runs where IGA_TEST_CLEAN_ROOT=1 is set: it downloads some 300 MB. IGA_DEBIAN_MIRROR names the server. Exit code 77: skipped."""
import os
import shutil
import subprocess
import sys
from pathlib import Path

from installation import run, skip

PACKAGES, ROOT = Path(sys.argv[1]), Path(sys.argv[2])
MIRROR = os.environ.get("IGA_DEBIAN_MIRROR", "http://deb.debian.org/debian")
COMMANDS = """
set -e
cp -r /usr/share/iga-trimmed-solids/samples /tmp/samples
cd /tmp
igaprep samples/10_aligned_box/prep.toml --quiet
igasolve check samples/parts/aligned_box.h5 --quiet
igasolve eigen samples/parts/aligned_box.h5 --material steel --modes 2 -o modes.h5 --quiet
iga modes samples/parts/aligned_box.stl --material steel --length-unit mm --modes 1 --degree 1 --quiet
if command -v igaprep-cad; then igaprep samples/14_bracket_from_step/bracket.step --list > /dev/null; fi
python3 -c "from igatools import iga_results; print(iga_results.read('modes.h5')['/frequencies'])"
"""


def make_root():
    """A Debian 12 with its base alone, which fetches packages the way this machine does."""
    run("debootstrap", "--variant=minbase", "bookworm", ROOT, MIRROR, timeout=500)
    for settings in Path("/etc/apt/apt.conf.d").glob("*proxy*"):
        shutil.copy(settings, ROOT / "etc/apt/apt.conf.d")


def in_root(*words):
    env = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "LC_ALL": "C.UTF-8", "HOME": "/root", "DEBIAN_FRONTEND": "noninteractive",
           **{name: value for name, value in os.environ.items() if name.endswith("_proxy")}}
    # The programs want /proc; in a name space of its own the mount ends with the command.
    with_proc = 'mount -t proc proc "$0/proc" && exec chroot "$0" "$@"'
    return run("unshare", "--mount", "sh", "-c", with_proc, ROOT, *words, env=env, timeout=900)


def main():
    if os.environ.get("IGA_TEST_CLEAN_ROOT") != "1":
        skip("IGA_TEST_CLEAN_ROOT=1 is not set (.ci/run sets it)")
    if os.geteuid() != 0:
        skip("a Debian in a folder takes root's rights")
    if not shutil.which("debootstrap"):
        skip("debootstrap is missing; apt-get install debootstrap")
    if subprocess.run(["unshare", "--mount", "true"], capture_output=True).returncode != 0:
        skip("this container may not mount /proc")
    shutil.rmtree(ROOT, ignore_errors=True)
    try:
        make_root()
        in_root("apt-get", "update", "-qq")
    except (AssertionError, subprocess.TimeoutExpired) as error:
        skip(f"no Debian can be made from {MIRROR}: {error}")
    for package in PACKAGES.glob("*.deb"):
        if not package.name.startswith("iga-trimmed-solids-dev"):
            shutil.copy(package, ROOT / "tmp")
    names = [f"/tmp/{path.name}" for path in (ROOT / "tmp").glob("*.deb")]
    in_root("apt-get", "install", "-y", "-qq", "--no-install-recommends", *names)
    print(in_root("bash", "-c", COMMANDS))
    in_root("apt-get", "remove", "-y", "-qq", "iga-trimmed-solids")
    left = list((ROOT / "usr/share/iga-trimmed-solids").rglob("*"))
    assert not left, f"left behind by apt-get remove: {left[:3]}"
    shutil.rmtree(ROOT)


if __name__ == "__main__":
    main()
