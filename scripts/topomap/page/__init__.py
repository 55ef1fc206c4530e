"""One page that tells all about explorations."""
