"""How an answer of any kind is told: what trends, tracks and positions write alike."""
