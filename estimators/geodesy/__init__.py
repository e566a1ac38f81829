"""Positions on and near the Earth: Cartesian, geodetic and local coordinates."""
