"""What all other packages use: errors, files, limits, progress, exit statuses."""
