//! The game's entry point.
fn main() {}
