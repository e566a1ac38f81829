"""Bytes to arrays and answers to bytes, one file per format."""
