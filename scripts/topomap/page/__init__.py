"""The report: one HTML page about explorations."""
