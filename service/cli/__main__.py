"""``python -m service.cli`` is the command ``plumbline``."""

from service.cli import app

app(prog_name="plumbline")
