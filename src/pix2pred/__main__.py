"""``python -m pix2pred``: the command line, for where its program is not on the path."""

from pix2pred.cli import main

if __name__ == "__main__":
    main()
