"""What is seen of the home world: rooms, tables and bins, small things, vessels, and the two bodies, as shapes."""
