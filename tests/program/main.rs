//! Tests of the program and of documents.

#[cfg(feature = "gpu")]
mod bench_gpu;
mod cli;
mod dfg;
mod documents;
mod extremes;
mod recipe;
mod report;
