"""What publishers, subscriptions, clients, timers and rates are set up with, one operator to a file."""
