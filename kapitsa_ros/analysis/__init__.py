"""From readings to the critical speed."""
