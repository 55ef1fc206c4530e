"""The paper's table and figures, and what lies beyond them."""
