from __future__ import annotations

from pathlib import Path

import pytest
from pydantic import SecretStr, ValidationError

from service.settings import Settings, SettingsError, is_loopback, load_settings

KEY = "a-key-that-is-long-enough"


def test_the_service_listens_on_loopback_by_default() -> None:
    assert is_loopback(Settings().host)


@pytest.mark.parametrize("host", ["127.0.0.1", "127.8.8.8", "::1", "localhost"])
def test_loopback_addresses_need_no_key(host: str) -> None:
    assert Settings(host=host).keys() == ()


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.168.1.5", "example.org", ""])
def test_other_addresses_are_refused_without_a_key(host: str) -> None:
    with pytest.raises(ValidationError, match="PLUMBLINE_API_KEYS"):
        Settings(host=host)


def test_other_addresses_are_taken_with_a_key() -> None:
    assert Settings(host="0.0.0.0", api_keys=SecretStr(KEY)).host == "0.0.0.0"


def test_keys_come_from_the_list_and_the_file(tmp_path: Path) -> None:
    file = tmp_path / "keys"
    file.write_text(f"# the second one\n\n  {KEY}-from-file \n")
    assert Settings(api_keys=SecretStr(f"{KEY}, {KEY}-too"), api_key_file=file).keys() == (
        KEY,
        f"{KEY}-too",
        f"{KEY}-from-file",
    )


@pytest.mark.parametrize("content", ["", "# nothing\n"])
def test_a_key_file_without_keys_is_refused(tmp_path: Path, content: str) -> None:
    file = tmp_path / "keys"
    file.write_text(content)
    with pytest.raises(ValidationError, match="holds no key"):
        Settings(api_key_file=file)


def test_a_key_file_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValidationError, match="cannot be read"):
        Settings(api_key_file=tmp_path / "missing")


@pytest.mark.parametrize("key", ["short", "with a blank in the middle", "schlüssel-mit-umlaut-ü"])
def test_keys_that_are_short_or_no_header_can_carry_are_refused(key: str) -> None:
    with pytest.raises(ValidationError, match="API key"):
        Settings(api_keys=SecretStr(key))


def test_settings_come_from_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PLUMBLINE_PORT", "9001")
    monkeypatch.setenv("PLUMBLINE_LOG_FORMAT", "console")
    settings = load_settings()
    assert (settings.port, settings.log_format) == (9001, "console")


def test_overrides_take_precedence_and_none_is_no_override(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PLUMBLINE_PORT", "9001")
    assert load_settings(port=9002).port == 9002
    assert load_settings(port=None).port == 9001


def test_an_error_names_the_variable_and_not_its_value(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PLUMBLINE_PORT", "tcp://10.0.0.1:8000")
    with pytest.raises(SettingsError) as caught:
        load_settings()
    assert str(caught.value).startswith("PLUMBLINE_PORT: ")
    assert "10.0.0.1" not in str(caught.value)


def test_an_error_never_shows_a_key(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PLUMBLINE_API_KEYS", "s3cret")
    with pytest.raises(SettingsError) as caught:
        load_settings()
    assert "s3cret" not in str(caught.value)
    assert "s3cret" not in repr(Settings(api_keys=SecretStr("s3cret-but-long-enough")))
