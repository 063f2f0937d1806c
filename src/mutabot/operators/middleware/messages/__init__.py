"""What befalls messages, requests and goals on their way, one operator to a file."""
