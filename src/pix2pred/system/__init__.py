"""What lies below everything: files that appear whole, optional packages, parallel work, packing of pictures."""
