"""Answers about positions: JSON, CSV of the satellites, GeoJSON, and the sky as a picture."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from estimators import Fix, Fixes
from service.codecs.json import dumps
from service.codecs.negotiation import best_offer
from service.errors import invalid_value
from service.positions import Located
from service.schemas.positions import PositionAnswerQuery, PositionFormat

#: Decimals of a coordinate: less than a millimetre.
_DEGREES, _METRES = 9, 4


def write_json(located: Located, query: PositionAnswerQuery) -> bytes:
    """``to_dict()`` of the answer, times in the form they came and rows in their order."""
    return dumps(_told(located, satellites=query.satellites))


def write_csv(located: Located, _query: PositionAnswerQuery) -> bytes:
    """One line per satellite and epoch, in the order the rows came; an empty cell is nothing finite."""
    told = _told(located, satellites=True)
    columns = {name: column for name, column in told["satellites"].items() if isinstance(column, list)}
    if "fixes" in told:
        times = list(told["fixes"]["time"])
        columns = {"time": [times[epoch] for epoch in columns["epoch"]], **columns}
    text = io.StringIO()
    lines = csv.writer(text, lineterminator="\n")
    lines.writerow(columns)
    lines.writerows([_cell(value) for value in row] for row in zip(*columns.values(), strict=True))
    return text.getvalue().encode()


def write_geojson(located: Located, _query: PositionAnswerQuery) -> bytes:
    """Feature of one epoch, or a collection of the epochs that have a position (RFC 7946)."""
    answer = located.answer
    if isinstance(answer, Fix):
        return dumps(answer.to_geojson())
    times = _times(answer, located)
    features = []
    for k, epoch in enumerate(answer):
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
                    "hpl_m": epoch.hpl_m,
                    "vpl_m": epoch.vpl_m,
                    "ambiguous": epoch.ambiguous,
                    "used": int(epoch.satellites.inlier.sum()),
                    "excluded": list(epoch.excluded),
                },
            }
        )
    return dumps({"type": "FeatureCollection", "features": features})


def write_svg(located: Located, query: PositionAnswerQuery) -> bytes:
    """Sky of one epoch as SVG; the same answer gives the same bytes."""
    return _draw(located, query, "svg")


def write_png(located: Located, query: PositionAnswerQuery) -> bytes:
    """Sky of one epoch as PNG."""
    return _draw(located, query, "png")


@dataclass(frozen=True, slots=True)
class PositionWriter:
    """A format of answers.

    Attributes
    ----------
    name : str
        As in ``?format=``.
    media_type, content_type : str
        As in ``Accept``, without parameters, and as in the answer's ``Content-Type``.
    write : callable
    picture : bool
        Whether it shows one epoch only.
    """

    name: PositionFormat
    media_type: str
    content_type: str
    write: Callable[[Located, PositionAnswerQuery], bytes]
    picture: bool = False


#: In the order of preference where the caller has none.
POSITION_WRITERS: tuple[PositionWriter, ...] = (
    PositionWriter("json", "application/json", "application/json", write_json),
    PositionWriter("csv", "text/csv", "text/csv; charset=utf-8; header=present", write_csv),
    PositionWriter("geojson", "application/geo+json", "application/geo+json", write_geojson),
    PositionWriter("svg", "image/svg+xml", "image/svg+xml", write_svg, picture=True),
    PositionWriter("png", "image/png", "image/png", write_png, picture=True),
)


def choose_position_writer(accept: str | None, asked: PositionFormat | None) -> PositionWriter:
    """Format of the answer: ``?format=`` first, then ``Accept`` by quality.

    Raises
    ------
    Problem
        406, with the formats there are, if none is accepted.

    Examples
    --------
    >>> choose_position_writer("application/geo+json, text/csv;q=0.5", None).name
    'geojson'
    """
    if asked is not None:
        return next(writer for writer in POSITION_WRITERS if writer.name == asked)
    wanted = best_offer(accept, [writer.media_type for writer in POSITION_WRITERS])
    return next(writer for writer in POSITION_WRITERS if writer.media_type == wanted)


def refuse_picture_of_many(writer: PositionWriter, *, many: bool) -> None:
    """Refuse before the work what cannot be drawn after it.

    Raises
    ------
    Problem
        422 if a picture of many epochs is wanted.
    """
    if writer.picture and many:
        raise invalid_value("format", "a sky plot shows one epoch; send one, or ask for json, csv or geojson")


def _told(located: Located, *, satellites: bool) -> dict[str, Any]:
    answer = located.answer
    if isinstance(answer, Fix):
        return answer.to_dict(satellites=satellites)
    told = answer.to_dict()
    told["fixes"]["time"] = _times(answer, located)
    if not satellites:
        del told["satellites"]
    elif located.place is not None:
        rows = located.place.tolist()
        told["satellites"] = {
            name: [column[row] for row in rows] for name, column in told["satellites"].items()
        }
    return told


def _times(fixes: Fixes, located: Located) -> list[Any]:
    """Write times as orjson and CSV take them, in the form they came."""
    if located.form is None:
        return [str(moment) for moment in fixes.time] if fixes.time.dtype.kind == "M" else fixes.time.tolist()
    rendered = located.form.render(fixes.time)
    if isinstance(rendered, list):
        return rendered
    if rendered.dtype.kind == "M":
        return [f"{moment}Z" for moment in rendered.astype("datetime64[s]")]
    plain: list[Any] = rendered.tolist()
    return plain


def _cell(value: Any) -> Any:
    if isinstance(value, bool):
        return "true" if value else "false"
    return "" if value is None or (isinstance(value, float) and not math.isfinite(value)) else value


def _draw(located: Located, query: PositionAnswerQuery, file_format: Literal["svg", "png"]) -> bytes:
    # Matplotlib takes longer to import than the whole service; who asks for no picture does not wait for it.
    from estimators.adapters.plotting import render  # noqa: PLC0415
    from estimators.adapters.position_plots import sky_figure  # noqa: PLC0415

    if not isinstance(located.answer, Fix):
        raise TypeError("a series has no sky plot; refuse_picture_of_many comes first")
    figure = sky_figure(
        located.answer,
        width_px=query.width_px,
        height_px=query.height_px,
        theme=query.theme,
        title=query.title,
    )
    return render(figure, file_format)
