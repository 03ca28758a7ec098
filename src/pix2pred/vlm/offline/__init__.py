"""The reader that is trained on a domain's pictures and asks nobody."""
