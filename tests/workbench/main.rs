//! Tests of the workbench.

mod analyze;
mod analyze_figures;
mod chart;
mod figures;
mod laboratory;
mod stretch;
