"""Exceptions and warnings.

Every message has a stable `id` (docs/reference/messages.md): "E-unknown-model", "W-measurement-failed", "N-…".
"""

from __future__ import annotations

from typing import Any, List, NamedTuple, Optional

__all__ = ["Error", "Interrupted", "Message", "PwlsimWarning", "RunError"]


class Message(NamedTuple):
    """One message of the simulator."""

    kind: str
    """"note", "warning" or "error"."""
    id: str
    """The stable id."""
    text: str
    """One sentence, with "; try …" if there is a fix."""
    full: str
    """With its location and the line."""


class PwlsimWarning(UserWarning):
    """A warning of the simulator; `id` is its stable id."""

    def __init__(self, text: str, id: str = "") -> None:
        super().__init__(text)
        self.id = id


class Error(Exception):
    """The circuit has mistakes, or something requested does not exist.

    >>> import pwlsim
    >>> try:
    ...     pwlsim.Circuit().diode("D1", "a", "0", model="fsat").run(stop=1)
    ... except pwlsim.Error as error:
    ...     error.id
    'E-unknown-model'
    """

    def __init__(self, text: str = "", id: str = "", messages: Optional[List[Message]] = None) -> None:
        super().__init__(text)
        self.id = id
        """The id of the first error."""
        self.messages: List[Message] = messages or []
        """All messages, including warnings and notes."""


class RunError(Error):
    """The run could not continue; `result` holds the rows up to then (None for a steady state that was not found).
    If a controller's function raised an exception, that is the cause."""

    result: Any = None


class Interrupted(KeyboardInterrupt):
    """Ctrl-C ended a run; `result` holds the rows up to then. At the prompt: ``sys.last_value.result``."""

    def __init__(self, result: Any = None) -> None:
        super().__init__("interrupted; the rows up to then are in the exception's result")
        self.result = result


def _messages(raw: List[tuple]) -> List[Message]:
    return [Message(*each) for each in raw]


def _fill(kind: type, raw: List[tuple]) -> Any:
    messages = _messages(raw)
    errors = [message for message in messages if message.kind == "error"]
    return kind("".join(message.full for message in errors).rstrip("\n"), errors[0].id if errors else "", messages)


def _error(raw: List[tuple], _result: Any) -> Error:
    return _fill(Error, raw)


def _run_error(raw: List[tuple], result: Any) -> RunError:
    from .result import Result

    error = _fill(RunError, raw)
    error.result = Result(result)
    return error
