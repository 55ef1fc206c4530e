"""Maps as pictures, in files and in the terminal."""
