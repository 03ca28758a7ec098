"""The objective J: planning effort over the demonstrations."""
