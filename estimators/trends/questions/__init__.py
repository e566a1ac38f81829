"""Questions people ask of a trend: when does it cross, do two differ, how steep is it per day."""
