"""The paper's own search: hypotheses, and the orders in which their tree is traversed."""
