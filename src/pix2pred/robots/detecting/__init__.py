"""Objects in pictures: boxes with scores for words, and outlines for boxes, from any detector behind one interface."""
