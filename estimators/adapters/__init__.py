"""Optional bridges to other libraries, each behind an extra; nothing imports them at module level."""
