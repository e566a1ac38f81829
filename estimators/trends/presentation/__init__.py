"""How an answer leaves Python: dict, data frame, text and HTML."""
