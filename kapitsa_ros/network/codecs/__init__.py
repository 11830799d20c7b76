"""One codec a kind of message."""
