"""The command line: thin verbs over the library."""

from pix2pred.cli.app import main

__all__ = ["main"]
