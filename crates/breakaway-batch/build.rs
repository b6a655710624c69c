//! Rust knows 512-bit vectors since 1.89; an older compiler builds without them.

use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(avx512)");
    let x86_64 = std::env::var("CARGO_CFG_TARGET_ARCH").is_ok_and(|arch| arch == "x86_64");
    if x86_64 && minor_version().is_some_and(|minor| minor >= 89) {
        println!("cargo::rustc-cfg=avx512");
    }
}

/// The 95 in `rustc 1.95.0 (...)`.
fn minor_version() -> Option<u32> {
    let compiler = std::env::var_os("RUSTC")?;
    let version = Command::new(compiler).arg("--version").output().ok()?.stdout;
    String::from_utf8(version).ok()?.split('.').nth(1)?.parse().ok()
}
