//! The LTC tables that this workspace ships, embedded.
