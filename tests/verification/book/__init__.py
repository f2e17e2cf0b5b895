"""The verification book: cases with exact or published values, run at three grids, and the page that shows them."""
from book import parts
from book.case import Case, case
from book.run import Run, run_file

__all__ = ["Case", "Run", "case", "parts", "run_file"]
