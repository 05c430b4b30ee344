"""The file that is being saved: the station makes its text, this end writes it. Knows no widget."""

from __future__ import annotations

from groundstation.ui.base.save_file import save_text
from groundstation.ui.display.request_numbers import RequestNumbers
from groundstation.ui.params.edit.files import SaveChoice
from groundstation.views.params import ParamExport, ParamExportRequest


class ParamSaving:
    """At most one file at a time."""

    def __init__(self, numbers: RequestNumbers) -> None:
        self._numbers = numbers
        self._choice: SaveChoice | None = None
        self._request: ParamExportRequest | None = None

    def start(self, choice: SaveChoice, group: str) -> None:
        """Request the text; `group` is for those who save one."""
        self._choice = choice
        self._request = ParamExportRequest(
            self._numbers.take(), choice.form, choice.part == "changed", group if choice.part == "group" else ""
        )

    @property
    def requests(self) -> tuple[ParamExportRequest, ...]:
        """What to request."""
        return (self._request,) if self._request else ()

    def take(self, view: ParamExport) -> str | None:
        """Write the text; return how it ended."""
        choice, request = self._choice, self._request
        if choice is None or request is None or view.number != request.number:
            return None
        self._choice = self._request = None
        problem = view.problem
        if not problem and (reason := save_text(choice.path, view.text)):
            problem = f"{choice.path}: {reason}"
        count = "1 parameter" if view.count == 1 else f"{view.count} parameters"
        return f"not saved: {problem}" if problem else f"{count} saved to {choice.path}{view.left_out}"
