"""What every other room uses: errors, files, limits, progress, exit statuses."""
