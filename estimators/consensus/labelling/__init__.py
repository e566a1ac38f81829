"""Labels of the points, and the noise scale that labels imply."""
