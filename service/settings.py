"""Settings of the service, from ``PLUMBLINE_*`` environment variables.

The defaults are safe on a shared machine: loopback only, everything bounded. An address that others can
reach is refused without an API key, here and not at the first request.
"""

from __future__ import annotations

import ipaddress
import os
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import Field, SecretStr, ValidationError, model_validator
from pydantic_settings import BaseSettings, SettingsConfigDict

LogFormat = Literal["json", "console"]
LogLevel = Literal["debug", "info", "warning", "error"]

#: Guessing a key of 16 characters over the network is out of reach; shorter ones are mostly words.
MIN_KEY_LENGTH = 16


class SettingsError(ValueError):
    """The environment asks for something the service will not do; the message says how to mend it."""


class Settings(BaseSettings):
    """Everything about a running service that is not code.

    Attributes
    ----------
    host : str
        Address to listen on (default 127.0.0.1).
    port : int
        Port to listen on, 0 for any free one (default 8000).
    api_keys : str
        Comma-separated keys (``PLUMBLINE_API_KEYS``).
    api_key_file : Path or None
        File with one key per line; empty lines and lines that start with ``#`` are left out.
    max_body_bytes : int
        Largest request body (default 32 MiB).
    max_buffered_bytes : int
        Bodies held in memory at one time, over all requests (default 256 MiB).
    body_seconds : float
        Longest time a body may take to arrive (default 30).
    max_points : int
        Most rows of a series or a batch, and most times of a prediction (default 1 000 000).
    max_series : int
        Most series of a batch (default 100 000).
    workers : int
        Fits that run at one time (default: one per processor).
    queue_length : int
        Requests that may wait for a worker (default 64).
    queue_seconds : float
        Longest wait before 503 (default 5).
    deadline_seconds : float
        Longest time from the whole body to the answer before 504 (default 30).
    max_connections : int
        Connections and requests held at one time; more are answered 503 at once (default 512).
    cors_origins : str
        Comma-separated origins whose pages may call the service (default none: CORS is off).
    log_level : str
        Least severity that is logged: ``debug``, ``info``, ``warning`` or ``error`` (default info).
    log_format : str
        ``json`` for programs, ``console`` for people (default json).

    Examples
    --------
    >>> Settings(port=9000).port
    9000
    """

    model_config = SettingsConfigDict(
        env_prefix="PLUMBLINE_", extra="forbid", frozen=True, hide_input_in_errors=True
    )

    host: str = "127.0.0.1"
    port: Annotated[int, Field(ge=0, le=65535)] = 8000
    api_keys: SecretStr = SecretStr("")
    api_key_file: Path | None = None
    max_body_bytes: Annotated[int, Field(ge=1_024, le=2**31)] = 32 * 2**20
    max_buffered_bytes: Annotated[int, Field(ge=1_024, le=2**40)] = 256 * 2**20
    body_seconds: Annotated[float, Field(gt=0, le=3_600, allow_inf_nan=False)] = 30.0
    max_points: Annotated[int, Field(ge=1, le=10**8)] = 1_000_000
    max_series: Annotated[int, Field(ge=1, le=10**8)] = 100_000
    workers: Annotated[int, Field(ge=1, le=1_024)] = Field(default_factory=lambda: os.cpu_count() or 1)
    queue_length: Annotated[int, Field(ge=0, le=100_000)] = 64
    queue_seconds: Annotated[float, Field(ge=0, le=3_600, allow_inf_nan=False)] = 5.0
    deadline_seconds: Annotated[float, Field(gt=0, le=3_600, allow_inf_nan=False)] = 30.0
    max_connections: Annotated[int, Field(ge=1, le=100_000)] = 512
    cors_origins: str = ""
    log_level: LogLevel = "info"
    log_format: LogFormat = "json"

    @model_validator(mode="after")
    def _keys_are_usable(self) -> Self:
        keys = self.keys()
        if any(len(key) < MIN_KEY_LENGTH for key in keys):
            raise ValueError(f"an API key is shorter than {MIN_KEY_LENGTH} characters; use a longer one")
        if any(not key.isascii() or not key.isprintable() or " " in key for key in keys):
            raise ValueError("an API key holds characters that a header cannot carry; use printable ASCII")
        if not keys and not is_loopback(self.host):
            raise ValueError(
                f"host {self.host} can be reached by others, so an API key is required: set "
                "PLUMBLINE_API_KEYS or PLUMBLINE_API_KEY_FILE, or listen on 127.0.0.1"
            )
        return self

    def keys(self) -> tuple[str, ...]:
        """List the API keys in force; none means that no key is asked for.

        Raises
        ------
        ValueError
            If the key file cannot be read or holds no key.
        """
        keys = [key.strip() for key in self.api_keys.get_secret_value().split(",") if key.strip()]
        if self.api_key_file is not None:
            try:
                lines = self.api_key_file.read_text(encoding="utf-8").splitlines()
            except (OSError, UnicodeDecodeError) as error:
                raise ValueError("api_key_file cannot be read as text") from error
            from_file = [line.strip() for line in lines if line.strip() and not line.lstrip().startswith("#")]
            if not from_file:
                raise ValueError("api_key_file holds no key")
            keys += from_file
        return tuple(keys)

    def allowed_origins(self) -> tuple[str, ...]:
        """Origins whose pages may call the service."""
        return tuple(origin.strip() for origin in self.cors_origins.split(",") if origin.strip())


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach an address.

    Examples
    --------
    >>> is_loopback("127.0.0.1"), is_loopback("::1"), is_loopback("0.0.0.0")
    (True, True, False)
    """
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def load_settings(**overrides: object) -> Settings:
    """Read the settings from the environment; an error names the variable.

    Parameters
    ----------
    **overrides
        Fields that take precedence over the environment, as a command line does; None is no override.

    Returns
    -------
    Settings

    Raises
    ------
    SettingsError
        With one line per variable that is wrong.
    """
    given = {name: value for name, value in overrides.items() if value is not None}
    try:
        return Settings(**given)  # type: ignore[arg-type]
    except ValidationError as error:
        lines = []
        for item in error.errors(include_input=False, include_url=False):
            name = "_".join(str(part) for part in item["loc"])
            message = item["msg"].removeprefix("Value error, ")
            lines.append(f"PLUMBLINE_{name.upper()}: {message}" if name else message)
        raise SettingsError("\n".join(lines)) from None
