"""Labels of fixes, found for the whole track at once."""
