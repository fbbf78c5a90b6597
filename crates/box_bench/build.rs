//! Passes the version of the compiler to the program.

use std::process::Command;

fn main() {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(rustc).arg("--version").output();
    let version = output.map_or_else(
        |_| "unknown compiler".to_owned(),
        |o| String::from_utf8_lossy(&o.stdout).trim().to_owned(),
    );
    println!("cargo:rustc-env=COMPILER={version}");
    println!("cargo:rerun-if-changed=build.rs");
}
