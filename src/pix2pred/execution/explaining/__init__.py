"""What a plan rests on, why there is none, and which labels were wrong."""
