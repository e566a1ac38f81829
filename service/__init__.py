"""Plumbline over HTTP: a thin shell of FastAPI around :mod:`estimators`."""
