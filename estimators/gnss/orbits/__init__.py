"""Where satellites are: broadcast ephemerides, evaluated at the time of transmission."""
