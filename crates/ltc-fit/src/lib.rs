//! Fits LTC tables to BRDFs.
