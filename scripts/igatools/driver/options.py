"""The command line of iga."""
import argparse
import re
from pathlib import Path

from igatools.driver import loads, units

COMMANDS = {"modes": "vibration modes", "static": "displacements and stresses under loads", "drop": "fall on a rigid floor",
            "impact": "run of explicit dynamics with the part in it, or a hit on a rigid wall",
            "buckling": "loads at which the part buckles", "heat": "steady temperatures", "harmonic": "frequency response",
            "random": "random vibration", "transient": "answer over time by superposition of modes"}
ANALYSES = ("buckling", "heat", "harmonic", "random", "transient")  # of a run file
ABOUT = {
    "modes": """Vibration modes, each frequency with its estimated error.

  iga modes part.step --material steel --tolerance 1%
  iga modes part.stl --length-unit mm --E 210e3 --nu 0.3 --rho 7.85e-9 --modes 6     one estimate, from two grids
  iga modes part.step --material steel --run supports.toml                           [[support]] tables""",
    "static": """Strain energy, displacements and stresses under loads, each with its estimated error.

  iga static part.step --material steel --fix "face 12" --force "face 3=0,0,-1000" --tolerance 2%
  iga static part.step --material steel --fix bore=pinned --pressure "lid=2 MPa" --gravity "0,0,-1 g" --probe tip=60,20,3
  iga static part.step --material steel --run loads.toml                     [[support]], [[load]], [[probe]] tables

Faces, edges and vertices have the names that igaprep part.step --list and --list-edges print. Numbers without a unit are in the
units of the run (steel on a part in mm: N, mm, MPa).""",
    "drop": """Fall of the part on a rigid floor: force, deformation, stress, energies.

  iga drop part.step --material steel --height 1.2m
  iga drop housing.step --material ABS --height 80cm --direction 1,0,-1 --yield-stress 40MPa --hardening 50MPa

The part starts just above the floor with the speed of the fall. Without --yield-stress it stays elastic.""",
    "impact": """A hit: the part flies against a rigid wall (--speed), or takes part in a run file of explicit dynamics (--run).

  iga impact part.step --material aluminium --speed 8m/s --direction 1,0,0
  iga impact part.step --run impact.toml --body bumper                     whose model the part replaces""",
    "buckling": """Factors on the loads of a run file at which the part buckles, each with its estimated error.

  iga buckling column.step --material steel --run press.toml --tolerance 2%""",
    "heat": """Steady temperatures at the probes of a run file and powers through its [[heat]] surfaces, with estimated errors.

  iga heat bracket.step --material steel --run hot.toml --tolerance 1%""",
    **{command: f"""Answers at the probes of a run file ({what}), each with its estimated error.

  iga {command} part.step --material steel --run shake.toml --tolerance 5%""" for command, what in (
        ("harmonic", "largest over the frequencies"), ("random", "root mean squares"), ("transient", "largest over the time"))}}


def number(words, least=None, what="a number"):
    try:
        value = float(words)
    except ValueError:
        value = float("nan")
    if not value > (least if least is not None else float("-inf")):
        raise argparse.ArgumentTypeError(f"found {words}, expected {what}")
    return value


def above_zero(words):
    return number(words, 0, "a number above 0")


def zero_or_more(words):
    return 0.0 if words == "0" else above_zero(words)


def count(words):
    value = number(words, 0, "a whole number above 0")
    if value != int(value):
        raise argparse.ArgumentTypeError(f"found {words}, expected a whole number above 0")
    return int(value)


def share(words):
    """"1%" or "0.01"."""
    percent = words.endswith("%")
    value = number(words.rstrip("%"), 0, "a share such as 1% or 0.01") / (100 if percent else 1)
    if value >= 1:
        raise argparse.ArgumentTypeError(f"found {words}, expected a share such as 1% or 0.01")
    return value


def words_of(read, *arguments, **options):
    """A reader that raises ValueError, for argparse."""
    def reader(words):
        try:
            return read(words, *arguments, **options)
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error)) from error
    return reader


def add_common(p, command):
    p.add_argument("part", type=Path, help="STEP, IGES, BREP, STL, OBJ, PLY or OFF")
    group = p.add_argument_group("material")
    group.add_argument("--material", metavar="NAME", help="such as steel; a wrong name makes igasolve list them all")
    for key, what in (("E", "Young's modulus, such as 210e3 N/mm² for a part in mm"), ("nu", "Poisson's ratio"),
                      ("rho", "density, such as 7.85e-9 t/mm³ for a part in mm")):
        group.add_argument(f"--{key}", type=above_zero, help=what)
    group.add_argument("--unit-system", choices=tuple(units.SYSTEMS), help="of all numbers [t-mm-s in mm, SI in m]")
    group = p.add_argument_group("part and grid")
    group.add_argument("--length-unit", help="of the part: mm, m … (CAD files know their own)")
    group.add_argument("--scale", type=above_zero, help="factor on all coordinates of the file [1]")
    group.add_argument("--region-angle", type=above_zero, metavar="DEG", 
                       help="split the surface of an STL file into faces, at edges sharper than this, such as 30")
    group.add_argument("--solid", metavar="NAME", help="of a CAD file with several")
    group.add_argument("--merge", action="store_true", help="one part of all solids of a CAD file, which must touch")
    group.add_argument("--repair", action="store_true", help="allow igaprep to change a faulty surface")
    group.add_argument("--wrap", action="store_true",
                       help="last resort: a closed surface around it instead, which only approximates the part")
    group.add_argument("--degree", type=int, default=2, choices=(1, 2, 3, 4), help="of the splines [2]")
    group.add_argument("--span-size", type=above_zero, help="of the first grid [from the part]")
    group = p.add_argument_group("running")
    group.add_argument("--tolerance", type=share, help="of every number, such as 1%% (default: two grids, whatever the error)")
    group.add_argument("--max-time", type=above_zero, default=600, metavar="S",
                       help="seconds in all [600]; a grid that was expected to fit in is stopped after half as much again")
    group.add_argument("--memory", type=above_zero, metavar="GIB", help="that one run may use [four fifths of what is free]")
    group.add_argument("--fresh", action="store_true", help="use no file of an earlier call")
    group.add_argument("-o", "--output", type=Path, help=f"folder [<part>_{command}; <part>_<solid>_{command} with --solid]")
    group.add_argument("--bin", type=Path, help="folder of igaprep and igasolve")
    group.add_argument("--json", action="store_true", help="the report as one JSON object on stdout")
    group.add_argument("--quiet", action="store_true", help="no progress")


def add_static(p):
    group = p.add_argument_group("supports and loads")
    group.add_argument("--run", type=Path, metavar="TOML", help="run file with [[support]], [[load]], [[probe]] tables")
    group.add_argument("--fix", action="append", default=[], type=words_of(loads.fix), metavar="NAME[=HOW]",
                       help="hold a face, edge or vertex: xyz (default), some of x, y, z; normal, pinned, radial")
    group.add_argument("--force", action="append", default=[], type=words_of(loads.placed, "force", 3), metavar="NAME=FX,FY,FZ",
                       help="spread evenly over a face or edge, or at a vertex")
    group.add_argument("--pressure", action="append", default=[], type=words_of(loads.placed, "stress", 1), metavar="NAME=P")
    group.add_argument("--gravity", type=words_of(units.typed, "acceleration", 3), metavar="GX,GY,GZ",
                       help='acceleration of gravity, such as "0,0,-1 g"')
    group.add_argument("--probe", action="append", default=[], type=words_of(loads.probe), metavar="[NAME=]X,Y,Z",
                       help="place whose displacement and stress are told, in the part's length unit")


def add_hit(p, command):
    group = p.add_argument_group("the hit")
    if command == "drop":
        group.add_argument("--height", required=True, type=words_of(units.typed, "length", must_have_unit=True), help="such as 1.2m")
        group.add_argument("--floor", choices=("rigid",), default="rigid", help="[rigid]")
    else:
        group.add_argument("--run", type=Path, metavar="TOML", help="run file of igasolve explicit")
        group.add_argument("--body", metavar="NAME", help="of the run file's bodies that is the part [the only one]")
        group.add_argument("--speed", type=words_of(units.typed, "speed", must_have_unit=True), help="such as 8m/s")
    group.add_argument("--direction", type=words_of(units.typed, "length", 3), default=units.typed("0,0,-1", "length", 3),
                       metavar="X,Y,Z", help="of the part's axes in which it flies [0,0,-1]")
    group.add_argument("--end", type=words_of(units.typed, "time", must_have_unit=True),
                       help="of the run, such as 3ms [when the part has left the wall]")
    group.add_argument("--friction", type=zero_or_more, help="coefficient [0.3 on a floor]")
    group.add_argument("--yield-stress", type=words_of(units.typed, "stress"), help="such as 235MPa: J2 plasticity [elastic]")
    group.add_argument("--viewer", action="store_true", help="write files for ParaView too (takes time)")
    group.add_argument("--hardening", type=words_of(units.typed, "stress"), help="stress per plastic strain [0]")


def parser_of(about):
    parser = argparse.ArgumentParser(prog="iga", description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True, metavar=" | ".join([*COMMANDS, "report"]))
    page = commands.add_parser("report", help="write report.html of a folder again", usage="iga report FOLDER")
    page.add_argument("folder", type=Path, help="the one that holds report.json")
    for command, what in COMMANDS.items():
        p = commands.add_parser(command, help=what, description=ABOUT[command], usage=f"iga {command} PART [options]",
                                formatter_class=argparse.RawDescriptionHelpFormatter)
        add_common(p, command)
        if command == "modes":
            p.add_argument("--modes", type=count, default=10, help="elastic modes [10]")
            p.add_argument("--run", type=Path, metavar="TOML", help="run file with supports, and the material where it is not given here")
        elif command == "static":
            add_static(p)
        elif command in ANALYSES:
            p.add_argument("--run", type=Path, metavar="TOML", required=True, help=f"run file of igasolve {command}")
        else:
            add_hit(p, command)
    return parser, commands


def complete(o, parser):
    """What follows from the words: flags of the programs, the output folder."""
    o.igaprep = [flag for flag, is_on in (("--repair", o.repair), ("--wrap", o.wrap), ("--merge", o.merge)) if is_on]
    for key, value in (("--scale", o.scale), ("--region-angle", o.region_angle), ("--solid", o.solid)):
        o.igaprep += [key, value] if value is not None else []
    o.run = getattr(o, "run", None)
    o.material_name = o.material
    o.material_numbers = {key: getattr(o, key) for key in ("E", "nu", "rho") if getattr(o, key) is not None}
    o.material = ["--material", o.material] if o.material else []
    o.material += [word for key, value in o.material_numbers.items() for word in (f"--{key}", value)]
    o.material += ["--unit-system", o.unit_system] if o.unit_system else []
    if not o.material_name and not o.run and len(o.material_numbers) < 3:
        parser.error("give --material NAME, or --E, --nu and --rho"
                     + ("" if o.command == "drop" else ", or a run file that has them (--run)"))
    if o.command == "impact" and bool(o.run) == bool(o.speed):
        parser.error("give a run file (--run) or the speed of the part against a rigid wall (--speed), one of the two")
    o.output = o.output or Path(f"{o.part.stem}{solid_in_name(o.solid)}_{o.command}")
    return o


def solid_in_name(solid):
    """Solids of one file have folders of their own."""
    return "_" + re.sub(r"[^\w.-]+", "_", solid) if solid else ""


def joined(words):
    """Options and the negative numbers behind them as one word: --direction -1,0,0 would otherwise be two options."""
    out = []
    for word in words:
        if out and out[-1].startswith("--") and "=" not in out[-1] and re.match(r"-[\d.]", word):
            out[-1] += "=" + word
        else:
            out.append(word)
    return out


def parse(words, about):
    parser, commands = parser_of(about)
    o = parser.parse_args(joined(words))
    return o if o.command == "report" else complete(o, commands.choices[o.command])
