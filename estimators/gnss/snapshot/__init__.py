"""One epoch: least squares from a cold start, the parity space, and the search for faulty satellites."""
