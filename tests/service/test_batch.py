from __future__ import annotations

import csv
import io
import json

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from fastapi.testclient import TestClient

from estimators import Trend, fit_trend, fit_trends
from service.codecs.batch.answer import FIGURES
from service.schemas.batch import BatchAnswer
from tests.service.series import CSV, JSON
from tests.service.tables import ENDPOINT, FORMATS, as_csv, as_json, as_stream, long_table

TABLE = long_table()


def ask(client: TestClient, query: str = "", table: pa.Table = TABLE, accept: str = "*/*") -> bytes:
    response = client.post(ENDPOINT + query, content=as_csv(table), headers=CSV | {"accept": accept})
    assert response.status_code == 200, response.text
    return response.content


def alone(table: pa.Table, name: str) -> Trend:
    rows = table.filter(pa.compute.equal(table["series"], name))
    trend = fit_trend(rows["time"].to_numpy(), rows["value"].to_numpy())
    assert isinstance(trend, Trend)
    return trend


@pytest.mark.parametrize("name", FORMATS)
def test_a_table_gets_the_same_answer_in_every_format(client: TestClient, name: str) -> None:
    media_type, write = FORMATS[name]
    query = "?points=true&format=ndjson"
    response = client.post(ENDPOINT + query, content=write(TABLE), headers={"content-type": media_type})
    assert response.status_code == 200, response.text
    assert response.content == ask(client, query)


def test_every_number_is_that_of_the_library_for_the_series_alone(client: TestClient) -> None:
    columns = json.loads(ask(client))["columns"]
    for place, name in enumerate(columns["series"]):
        rows = TABLE.filter(pa.compute.equal(TABLE["series"], name))
        table = fit_trends(rows["time"].to_numpy(), rows["value"].to_numpy(), [0, rows.num_rows])
        for parameter, estimates in table.parameters.items():
            assert columns[parameter][place] == estimates.value[0]
            for part in ("stderr", "low", "high"):
                assert columns[f"{parameter}_{part}"][place] == getattr(estimates, part)[0]
        for figure in ("origin", "n", "inliers", *FIGURES):
            assert columns[figure][place] == getattr(table, figure)[0]
        assert columns["notices"][place] == list(table.notices[0])


def test_series_come_in_the_order_in_which_they_first_appear(client: TestClient) -> None:
    names = TABLE["series"].to_pylist()
    assert json.loads(ask(client))["columns"]["series"] == list(dict.fromkeys(names))


def test_the_json_answer_is_as_its_schema_says(client: TestClient) -> None:
    for query in ("", "?points=true"):
        BatchAnswer.model_validate_json(ask(client, query), strict=True)


def test_points_name_the_row_of_the_table_that_they_were(client: TestClient) -> None:
    for row in map(json.loads, ask(client, "?points=true&format=ndjson").splitlines()):
        rows = row["point_row"]
        assert {TABLE["series"][k].as_py() for k in rows} == {row["series"]}
        assert row["point_time"] == [TABLE["time"][k].as_py() for k in rows]
        trend = alone(TABLE, row["series"])
        assert row["point_inlier"] == trend.points.inlier.tolist()
        assert row["point_reason"] == trend.points.reason


def test_csv_has_a_line_per_series_and_with_points_a_line_per_row(client: TestClient) -> None:
    by_series = list(csv.DictReader(io.StringIO(ask(client, "?format=csv").decode())))
    assert [row["series"] for row in by_series] == list(dict.fromkeys(TABLE["series"].to_pylist()))
    assert {row["fitted"] for row in by_series} == {"true"}
    by_row = list(csv.DictReader(io.StringIO(ask(client, "?format=csv&points=true").decode())))
    assert sorted(int(row["row"]) for row in by_row) == list(range(TABLE.num_rows))


@pytest.mark.parametrize("query", ["", "&points=true"])
def test_arrow_parquet_and_ndjson_hold_the_same_rows(client: TestClient, query: str) -> None:
    stream = pa.ipc.open_stream(ask(client, "?format=arrow" + query)).read_all()
    parquet = pq.read_table(io.BytesIO(ask(client, "?format=parquet" + query)))
    lines = [json.loads(line) for line in ask(client, "?format=ndjson" + query).splitlines()]
    assert stream.to_pylist() == parquet.to_pylist() == lines
    assert stream.schema.metadata[b"plumbline.method"] == b"auto"


def test_geojson_puts_every_series_where_it_stands(client: TestClient) -> None:
    table = long_table(2)
    is_first = np.array(table["series"].to_pylist()) == "s0"
    table = table.append_column("lat", pa.array(np.where(is_first, 47.5, np.nan), from_pandas=True))
    table = table.append_column("lon", pa.array(np.where(is_first, 8.5, np.nan), from_pandas=True))
    answer = json.loads(ask(client, "", table, "application/geo+json"))
    assert answer["type"] == "FeatureCollection"
    places = {feature["id"]: feature["geometry"] for feature in answer["features"]}
    assert places == {"s0": {"type": "Point", "coordinates": [8.5, 47.5]}, "s1": None}
    assert all(feature["properties"]["fitted"] for feature in answer["features"])


def test_geojson_without_positions_is_not_acceptable_and_says_why(client: TestClient) -> None:
    response = client.post(ENDPOINT + "?format=geojson", content=as_csv(TABLE), headers=CSV)
    assert response.status_code == 406
    assert "lat" in response.json()["detail"]


def test_a_series_without_a_trend_is_a_row_with_its_reason(client: TestClient) -> None:
    extra = pa.table(
        {
            "series": ["one", "flat", "flat", "gone", "gone"],
            "time": [1, 2, 2, 1, 2],
            "value": [1.0, 1.0, 2.0, None, None],
        }
    )
    answer = json.loads(ask(client, "", pa.concat_tables([TABLE, extra])))["columns"]
    rows = {name: k for k, name in enumerate(answer["series"])}
    reasons = {name: answer["reason"][rows[name]] for name in ("one", "flat", "gone")}
    assert reasons == {"one": "too_few_points", "flat": "constant_time", "gone": "no_data"}
    assert [answer["slope"][rows[name]] for name in reasons] == [None, None, None]
    assert [answer["fitted"][rows[f"s{k}"]] for k in range(5)] == [True] * 5


def test_very_many_series_of_one_point_are_all_answered(make_client: object) -> None:
    client: TestClient = make_client()  # type: ignore[operator]
    count = 20_000
    table = pa.table({"series": np.arange(count), "time": np.zeros(count), "value": np.ones(count)})
    response = client.post(
        ENDPOINT, content=as_stream(table), headers={"content-type": FORMATS["arrow stream"][0]}
    )
    assert response.status_code == 200
    columns = response.json()["columns"]
    assert columns["series"] == list(range(count))
    assert set(columns["reason"]) == {"too_few_points"}


def test_integers_name_series_and_stay_integers(client: TestClient) -> None:
    body = json.dumps({"series": [7, 7, 8, 8], "time": [0, 1, 0, 1], "value": [0, 1, 0, 2]})
    answer = client.post(ENDPOINT, content=body, headers=JSON).json()
    assert answer["columns"]["series"] == [7, 8]


def test_names_are_kept_as_they_are(client: TestClient) -> None:
    text = 'series,time,value\nNA,0,1\nNA,1,2\nnull,0,1\nnull,1,2\n"a,b",0,1\n"a,b",1,2\n 1,0,1\n'
    answer = client.post(ENDPOINT, content=text, headers=CSV).json()
    assert answer["columns"]["series"] == ["NA", "null", "a,b", " 1"]


def test_times_come_back_in_the_form_they_came(client: TestClient) -> None:
    iso = "series,time,value\n" + "".join(f"a,2024-05-0{k}T12:00:00Z,{k}.5\n" for k in range(1, 6))
    answer = client.post(ENDPOINT + "?points=true", content=iso, headers=CSV).json()
    assert answer["time_unit"] == "second"
    assert answer["columns"]["origin"] == ["2024-05-01T12:00:00Z"]
    epoch = "series,time,value\n" + "".join(f"a,{10**12 + k},{k}.5\n" for k in range(5))
    answer = client.post(ENDPOINT + "?points=true&time_unit=ms", content=epoch, headers=CSV).json()
    assert answer["columns"]["point_time"] == [[10**12 + k for k in range(5)]]


def test_the_arguments_of_the_fit_are_query_parameters(client: TestClient) -> None:
    answer = json.loads(ask(client, "?method=theil-sen&level=0.9&threshold=1.5&options.confidence=0.9"))
    assert (answer["method"], answer["level"]) == ("theil-sen", 0.9)
    assert set(answer["columns"]["threshold"]) == {1.5}


def test_columns_are_found_by_the_names_that_the_caller_gives(client: TestClient) -> None:
    renamed = TABLE.rename_columns(["station", "when", "level"])
    query = "?series_column=station&time_column=when&value_column=level"
    assert ask(client, query, renamed) == ask(client)
    answer = client.post(ENDPOINT + query, content=as_json(renamed), headers=JSON)
    assert answer.content == ask(client)


def test_weights_take_part(client: TestClient) -> None:
    weights = pa.array(np.tile([1.0, 4.0], TABLE.num_rows // 2))
    weighted = json.loads(ask(client, "", TABLE.append_column("weight", weights)))
    assert weighted["columns"]["slope"] != json.loads(ask(client))["columns"]["slope"]


def test_an_infinite_value_is_a_row_that_takes_no_part(client: TestClient) -> None:
    table = long_table(1)
    values = table["value"].to_numpy().copy()
    values[4] = np.inf
    body = as_stream(table.set_column(2, "value", pa.array(values)))
    response = client.post(
        ENDPOINT + "?points=true", content=body, headers={"content-type": FORMATS["arrow stream"][0]}
    )
    assert response.json()["columns"]["point_reason"][0][4] == "invalid"
