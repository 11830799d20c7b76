"""The person's bench in a browser."""
