"""pix2pred: learn symbolic world models from images with vision-language models, and plan with them."""

__version__ = "0.1.0"
