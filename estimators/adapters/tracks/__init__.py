"""Files of recorded tracks, in and out: one file per format, numpy columns between them."""

from estimators.adapters.tracks.assembly import assemble
from estimators.adapters.tracks.cleaned import Cleaned
from estimators.adapters.tracks.cleaning import clean_recording
from estimators.adapters.tracks.csv_writer import write_csv
from estimators.adapters.tracks.geojson_writer import write_geojson
from estimators.adapters.tracks.gpx_writer import write_gpx
from estimators.adapters.tracks.reading import read_track
from estimators.adapters.tracks.recording import Recording, RowFault
from estimators.adapters.tracks.streaming import clean_file, stream_track

__all__ = [
    "Cleaned",
    "Recording",
    "RowFault",
    "assemble",
    "clean_file",
    "clean_recording",
    "read_track",
    "stream_track",
    "write_csv",
    "write_geojson",
    "write_gpx",
]
