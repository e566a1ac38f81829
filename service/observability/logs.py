"""Logs: one line per request, as JSON or for people, on standard error.

Lines carry neither bodies nor query strings nor keys. No global state is configured here except for
uvicorn's own loggers, and those only by :func:`uvicorn_log_config`.
"""

from __future__ import annotations

import logging
import sys
from typing import Any, cast

import structlog
from structlog.typing import FilteringBoundLogger, Processor

from service.settings import LogFormat, Settings


def make_logger(settings: Settings) -> FilteringBoundLogger:
    """Logger of one app, with the level and format of its settings."""
    level = logging.getLevelNamesMapping()[settings.log_level.upper()]
    return cast(
        "FilteringBoundLogger",
        structlog.wrap_logger(
            structlog.WriteLogger(sys.stderr),
            processors=[*_shared(), structlog.processors.format_exc_info, _renderer(settings.log_format)],
            wrapper_class=structlog.make_filtering_bound_logger(level),
            context_class=dict,
        ),
    )


def uvicorn_log_config(settings: Settings) -> dict[str, Any]:
    """Configure uvicorn's own log lines to look like ours; its access log is off."""
    return {
        "version": 1,
        "disable_existing_loggers": False,
        "formatters": {
            "plumbline": {
                "()": structlog.stdlib.ProcessorFormatter,
                "foreign_pre_chain": [*_shared(), structlog.stdlib.ExtraAdder(allow=())],
                "processors": [
                    structlog.stdlib.ProcessorFormatter.remove_processors_meta,
                    structlog.processors.format_exc_info,
                    _renderer(settings.log_format),
                ],
            }
        },
        "handlers": {
            "stderr": {
                "class": "logging.StreamHandler",
                "formatter": "plumbline",
                "stream": "ext://sys.stderr",
            }
        },
        "loggers": {
            "uvicorn": {"handlers": ["stderr"], "level": settings.log_level.upper(), "propagate": False},
            "uvicorn.access": {"handlers": [], "level": "CRITICAL", "propagate": False},
        },
    }


def _shared() -> list[Processor]:
    return [structlog.processors.add_log_level, structlog.processors.TimeStamper(fmt="iso", utc=True)]


def _renderer(log_format: LogFormat) -> Processor:
    if log_format == "json":
        return structlog.processors.JSONRenderer()
    return structlog.dev.ConsoleRenderer(colors=sys.stderr.isatty())
