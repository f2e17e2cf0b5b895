"""three.js, which draws the 3-D view: Debian's package, put into the page as it is."""
from pathlib import Path

PLACES = [Path("/usr/share/javascript/three/three.min.js")]
LICENCE = Path(__file__).with_name("three_licence.txt")
ABSENT = ("The 3-D view is missing: three.js was not installed where this page was written. Install it (Debian: apt-get install "
          "libjs-three) and write the page again: scripts/iga report FOLDER.")


def library(places=None):
    """Text of the library; None where it is not installed."""
    found = next((place for place in places or PLACES if place.is_file()), None)
    return found.read_text(encoding="utf-8") if found else None
