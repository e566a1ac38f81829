"""Answers about positions as documents: JSON and GeoJSON."""

from __future__ import annotations

import math
from typing import Any

from estimators import Fix, Fixes
from service.codecs.json import dumps
from service.positions.located import Located
from service.schemas.position_query import PositionAnswerQuery

#: Decimals of a coordinate: less than a millimetre.
_DEGREES, _METRES = 9, 4


def write_json(located: Located, query: PositionAnswerQuery) -> bytes:
    """``to_dict()`` of the answer, times in the form they came and rows in their order."""
    answer = located.answer
    if isinstance(answer, Fix):
        told = answer.to_dict(satellites=query.satellites)
        if located.time is not None:
            told = {"time": written_times(located)[0], **told}
    else:
        told = answer.to_dict()
        told["fixes"]["time"] = written_times(located)
        if not query.satellites:
            del told["satellites"]
        elif located.place is not None:
            rows = located.place.tolist()
            told["satellites"] = {
                name: [column[row] for row in rows] for name, column in told["satellites"].items()
            }
    if query.satellites and located.row is not None:
        told["satellites"]["row"] = located.row.tolist()
    if query.satellites and located.left_out is not None:
        lost = located.left_out
        told["left_out"] = {
            "row": lost.row.tolist(),
            "satellite": list(lost.satellite),
            "reason": list(lost.reason),
        }
    return dumps(told)


def write_geojson(located: Located, _query: PositionAnswerQuery) -> bytes:
    """Feature of one epoch, or a collection of the epochs that have a position (RFC 7946)."""
    answer = located.answer
    if isinstance(answer, Fixes):
        return dumps({"type": "FeatureCollection", "features": _features(answer, written_times(located))})
    feature = answer.to_geojson()
    if located.time is not None:
        feature["properties"] = {"time": written_times(located)[0], **feature["properties"]}
    return dumps(feature)


def written_times(located: Located) -> list[Any]:
    """List the times of the epochs as orjson and CSV take them, in the form they came."""
    if located.form is None or located.time is None:
        return []
    rendered = located.form.render(located.time)
    if isinstance(rendered, list):
        return rendered
    if rendered.dtype.kind == "M":
        return [f"{moment}Z" for moment in rendered.astype("datetime64[s]")]
    plain: list[Any] = rendered.tolist()
    return plain


def _features(fixes: Fixes, times: list[Any]) -> list[dict[str, Any]]:
    features = []
    for k, epoch in enumerate(fixes):
        if not epoch:
            continue
        place = epoch.geodetic
        features.append(
            {
                "type": "Feature",
                "geometry": {
                    "type": "Point",
                    "coordinates": [
                        round(place.lon_deg, _DEGREES),
                        round(place.lat_deg, _DEGREES),
                        round(place.height_m, _METRES),
                    ],
                },
                "properties": {
                    "time": times[k],
                    "status": epoch.status,
                    "hpl_m": _finite(epoch.hpl_m),
                    "vpl_m": _finite(epoch.vpl_m),
                    "ambiguous": epoch.ambiguous,
                    "used": int(epoch.satellites.inlier.sum()),
                    "excluded": list(epoch.excluded),
                },
            }
        )
    return features


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
