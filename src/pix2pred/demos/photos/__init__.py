"""Photos of cameras and telephones: reading them, and copying them without what they tell besides."""
