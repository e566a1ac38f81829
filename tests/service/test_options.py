from __future__ import annotations

import dataclasses
import inspect

import pytest
from pydantic import ValidationError

import estimators
from estimators import RobustOptions, fit_trend
from service.schemas.options import AnswerQuery, FitArguments, TrendOptions, TrendQuery, TrendRequest


def test_options_are_those_of_the_library_with_its_defaults() -> None:
    library = {item.name: item.default for item in dataclasses.fields(RobustOptions)}
    assert TrendOptions().model_dump() == library


def test_arguments_have_the_defaults_of_the_library() -> None:
    signature = inspect.signature(fit_trend).parameters
    ours = FitArguments().model_dump(exclude={"time_unit", "options"})
    assert ours == {name: signature[name].default for name in ours}


def test_the_query_offers_csv_bodies_every_argument_and_option() -> None:
    offered = {field.alias or name for name, field in TrendQuery.model_fields.items()}
    arguments = set(FitArguments.model_fields) - {"options"}
    options = {f"options.{name}" for name in TrendOptions.model_fields}
    columns = {"time_column", "value_column", "weight_column", "predict", "horizon", "columns"}
    assert offered == set(AnswerQuery.model_fields) | arguments | options | columns


def test_arguments_in_the_query_become_those_of_a_json_body() -> None:
    query = TrendQuery.model_validate({"level": "0.9", "options.confidence": "0.5", "points": "false"})
    assert query.fit_arguments() == {"level": 0.9, "options": {"confidence": 0.5}}
    assert query.csv_only() == ["level", "options.confidence"]


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("level", 0),
        ("level", 1.0),
        ("level", "0.5"),
        ("level", True),
        ("threshold", 0.0),
        ("sigma", -1.0),
        ("sigma", float("nan")),
        ("sigma", float("inf")),
        ("seed", -1),
        ("seed", 1.5),
        ("seed", True),
        ("model", "parabola-of-nobody"),
        ("method", "no-such-method"),
        ("time_unit", "h"),
        ("options", {"confidence": 1.0}),
        ("options", {"max_hypotheses": 0}),
        ("options", {"correct_serial_correlation": 1}),
        ("options", {"no_such_option": 1}),
    ],
)
def test_arguments_out_of_range_or_of_another_type_are_refused(name: str, value: object) -> None:
    with pytest.raises(ValidationError):
        FitArguments.model_validate({name: value})


@pytest.mark.parametrize("method", list(estimators.methods()))
def test_every_registered_method_is_offered(method: str) -> None:
    assert FitArguments(method=method).method == method
    assert method in TrendRequest.model_json_schema()["properties"]["method"]["enum"]


@pytest.mark.parametrize("model", list(estimators.models()))
def test_every_registered_model_is_offered(model: str) -> None:
    assert FitArguments(model=model).model == model
    assert model in TrendRequest.model_json_schema()["properties"]["model"]["enum"]
