"""The track under its labels: positions, velocities and their covariance."""
