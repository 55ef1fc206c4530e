"""What every part stands on: errors, files, limits, progress, exit statuses."""
