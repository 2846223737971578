//! The test suite: one binary, a module a concern.
