"""What ``import topomap`` gives."""
