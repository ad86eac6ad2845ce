"""A run as one self-contained HTML page, made from a study of its log and one more pass over it."""

from __future__ import annotations

from pathlib import Path

from logs.page.document import document
from logs.page.record import Record
from logs.reader import read_run
from logs.run_log import LogWriteError
from logs.study import Study


def write_page(found: Study, path_out: str | Path) -> None:
    """Draw the log that was studied as one HTML page that needs nothing else.

    The page stays below 8 MB however long the run was: what is too much to draw is thinned,
    and the page says so. Raises LogReadError if the log is not there any more, LogWriteError if
    ``path_out`` cannot be written.
    """
    record = Record()
    with read_run(found.analysis.path) as reader:
        for sent in reader:
            record.hear(sent)
    page = document(found, record)
    try:
        Path(path_out).write_text(page, encoding="utf-8")
    except OSError as error:
        raise LogWriteError(f"{path_out}: cannot write the page: {error.strerror}") from error
