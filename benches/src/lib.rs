//! Run time against error.
