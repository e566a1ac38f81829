"""Methods of fault exclusion: one file each, one row each in the registry."""
