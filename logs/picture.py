"""A run as one self-contained HTML page, made from one pass over its log."""

from __future__ import annotations

from pathlib import Path

from logs.analysis import Analysis, Tally
from logs.page.document import document
from logs.page.record import Record
from logs.reader import read_run
from logs.run_log import LogWriteError


def write_page(path_in: str | Path, path_out: str | Path) -> Analysis:
    """Draw a log as one HTML page that needs nothing else; returns its analysis.

    The page stays below 8 MB however long the run was: what is too much to draw is thinned,
    and the page says so. Raises LogReadError if ``path_in`` is not the log of a run,
    LogWriteError if ``path_out`` cannot be written.
    """
    tally, record = Tally(), Record()
    with read_run(path_in) as reader:
        for sent in reader:
            tally.hear(sent)
            record.hear(sent)
    analysis = tally.analysis(reader)
    page = document(analysis, record, tally.ledger)
    try:
        Path(path_out).write_text(page, encoding="utf-8")
    except OSError as error:
        raise LogWriteError(f"{path_out}: cannot write the page: {error.strerror}") from error
    return analysis
