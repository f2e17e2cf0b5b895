"""From the command line of iga to its report and exit code."""
import json
import signal
import sys

from igatools.driver import options, printed
from igatools.whole_file import write_text
from igatools.driver.programs import Failed, Programs, RunError
from igatools.driver.progress import Progress
from igatools.report import NoReport, rewrite_page, write_page

NOT_REACHED, INTERRUPTED = 4, 130


def command_of(o, programs):
    """The run of a command; each is imported where it is wanted."""
    if o.command == "modes":
        from igatools.driver.modes import ModesRun
        return ModesRun(programs, o)
    if o.command == "static":
        from igatools.driver.static import StaticRun
        return StaticRun(programs, o)
    if o.command in options.ANALYSES:
        from igatools.driver.analyses import AnalysisRun
        return AnalysisRun(programs, o)
    if o.command == "impact" and o.run:
        from igatools.driver.impact import ImpactRun
        return ImpactRun(programs, o)
    from igatools.driver.hit import HitRun
    return HitRun(programs, o)


def check(o):
    """Before anything runs or is written."""
    for path in (o.part, o.run):
        if path and not path.is_file():
            raise Failed(f"{path}: {'is a folder, expected a file' if path.is_dir() else 'no such file'}", 2)
    if o.command == "static":
        from igatools.driver.static import refuse_doubled
        refuse_doubled(o)


def make_folder(path):
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise Failed(f"{path}: cannot be made ({error.strerror}); choose another folder for the output with -o", 2) from error


def rewrite(folder):
    """The page of an earlier call again."""
    try:
        print(f"written      {rewrite_page(folder)}")
    except NoReport as missing:
        print(f"iga: error: {missing}", file=sys.stderr)
        return 2
    return 0


def stop(number, frame):
    raise KeyboardInterrupt


def main(words, about):
    signal.signal(signal.SIGTERM, stop)
    o = options.parse(words, about)
    if o.command == "report":
        return rewrite(o.folder)
    try:
        check(o)
        make_folder(o.output)
        report = command_of(o, Programs(o.output, Progress(o.quiet), o.bin)).run()
    except (RunError, OSError) as failure:
        print(f"iga: error: {failure}", file=sys.stderr)
        return getattr(failure, "code", 2)
    except KeyboardInterrupt:
        print(f"iga: interrupted before the first grid was done; models made so far stay in {o.output} for the next call",
              file=sys.stderr)
        return INTERRUPTED
    report["folder"] = str(o.output)
    write_text(o.output / "report.json", json.dumps(report, indent=1) + "\n")
    page = write_page(o.output, report)
    print(json.dumps(report) if o.json else f"{printed.text(report)}written      {page}")
    if report["interrupted"]:
        print(f"iga: interrupted; the report of what is done stands in {o.output / 'report.json'}, the next call goes on from there",
              file=sys.stderr)
        return INTERRUPTED
    return 0 if report["reached"] else NOT_REACHED
