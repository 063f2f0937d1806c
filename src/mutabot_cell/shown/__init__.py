"""What the cell shows of itself: to pictures, and to mutabot while a test is recorded."""
