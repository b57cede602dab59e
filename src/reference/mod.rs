//! The same drawing computed another way, slowly: the truth the tests compare with.
