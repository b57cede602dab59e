//! Takes pixel rows, makes a file.
