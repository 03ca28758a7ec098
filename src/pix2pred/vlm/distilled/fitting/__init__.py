"""Training a distilled reader from labelled looks."""
