//! Comparisons to a page to look at.
