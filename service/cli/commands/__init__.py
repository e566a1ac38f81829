"""Signatures of the commands, a file each; nothing here may import more than typer."""
