"""Reports as plain Python."""

from __future__ import annotations

import json
from typing import Any, Dict

from . import _graticule as g


def report_dict(report: g.Report) -> Dict[str, Any]:
    """The report as `graticule solve --json` prints it: numbers, texts, lists and dictionaries."""
    result: Dict[str, Any] = json.loads(g.report_json(report))
    return result
