//! Versioned LTC tables: axes, channels, lookup, manifest, digest, codecs.
