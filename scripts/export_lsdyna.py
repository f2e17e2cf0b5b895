#!/usr/bin/python3
"""Writes a run of igasolve explicit as a deck for LS-DYNA, with the cells of its models as generalized solid elements.

  scripts/export_lsdyna.py run.toml -o deck.k
  scripts/export_lsdyna.py part.h5 run.toml -o deck.k [--thickness T] [--force] [--quiet]

run.toml is the run file of `igasolve explicit`; part.h5, if given, stands for the model of its only body. Exported are
bodies with materials linear-elastic, j2 (cowper-symonds), crushable-foam, their place, velocity and spin,
light_functions none and linear, rigid bodies of all shapes and motions, contacts with friction and regions,
self-contact, gravity, dead loads on regions and volumes, [time] end, safety, dt_max, [output] interval and
field_interval. What the deck leaves out or holds otherwise is listed at its top and on the screen; what it cannot hold
is refused. LS-DYNA itself has not run these decks: schema/README.md, section LS-DYNA, says what was checked.

Exit codes: 0 done, 2 run file or options, 3 a model file.
"""

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from igatools.iga_schema import FormatError  # noqa: E402
from igatools.lsdyna.cards import DeckError  # noqa: E402
from igatools.lsdyna.writer import Writer  # noqa: E402
from igatools.whole_file import write_text  # noqa: E402


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", metavar="FILE", help="[part.h5] run.toml")
    parser.add_argument("-o", "--output", required=True, help="deck to be written")
    parser.add_argument(
        "--thickness", type=float, metavar="T", help="thickness of surfaces in contact, length [span / 20]"
    )
    parser.add_argument("--force", action="store_true", help="overwrite the deck")
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")
    arguments = parser.parse_args()
    if len(arguments.files) > 2:
        parser.error(f"{len(arguments.files)} files; expected [part.h5] run.toml")
    output = Path(arguments.output)
    if output.exists() and not arguments.force:
        return _failed(f"{output} exists; give --force to overwrite it", 2)
    try:
        writer = Writer(
            arguments.files[-1], arguments.files[0] if len(arguments.files) == 2 else None, arguments.thickness
        )
        write_text(output, writer.text)
    except FormatError as error:
        return _failed(f"{error}", 3)
    except (DeckError, OSError) as error:
        return _failed(f"{error}", 2)
    if not arguments.quiet:
        print("\n".join(writer.report))
        print(f"{output}: {output.stat().st_size / 1e6:.1f} MB")
    return 0


def _failed(text, code):
    print(f"export_lsdyna.py: {text}", file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())
