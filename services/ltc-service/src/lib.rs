//! The HTTP service that hands out versioned LTC tables.
