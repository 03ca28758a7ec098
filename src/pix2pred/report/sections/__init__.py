"""What each section of the report shows, made from a run's contents."""
