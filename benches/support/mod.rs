//! What the benchmark is made of, in the order in which it is used.

pub mod drawings;
pub mod machine;
pub mod measure;
pub mod random;
pub mod renderers;
pub mod report;
pub mod scenes;
pub mod vello;
