"""From recorded fixes, in columns or in files, to cleaned tracks."""
