"""A track while it is recorded: labels and places that are final after a bounded delay."""
