"""The report as one page, report.html beside report.json: opens in a browser, without a network."""
import json
from pathlib import Path

from igatools.report import page
from igatools.whole_file import write_text

JSON_NAME, PAGE_NAME = "report.json", "report.html"


class NoReport(Exception):
    """What is missing or wrong, in words."""


def write_page(folder, report):
    """Writes the page of a report (the object of report.json) whose files lie in or below `folder`; its path."""
    folder = Path(folder)
    target = folder / PAGE_NAME
    write_text(target, page.html(report, folder))
    return target


def rewrite_page(folder):
    """Writes the page of a folder that holds a report.json again; its path."""
    source = Path(folder) / JSON_NAME
    try:
        report = json.loads(source.read_text())
    except FileNotFoundError:
        raise NoReport(f"{source}: no such file; name a folder that scripts/iga wrote") from None
    except ValueError as error:
        raise NoReport(f"{source}: is not JSON ({error}); run scripts/iga again") from None
    return write_page(folder, report)
