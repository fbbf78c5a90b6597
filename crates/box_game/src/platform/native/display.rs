//! Checks for a window and a GPU before they are used.
//!
//! winit and Bevy panic without a display, without one of its libraries and without a graphics driver. A child process
//! therefore makes the attempt, and its last output gives the reason.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::platform::{Need, Unavailable};

/// Time for the display and the driver to answer. A cold software driver takes a second.
const PATIENCE: Duration = Duration::from_secs(30);

const NO_DISPLAY: &str = "Run the game in a desktop session, or with a virtual display: \
    xvfb-run -a cargo run --release";
const NO_LIBRARY: &str = "On Debian and Ubuntu: apt-get install libx11-6 libx11-xcb1 libxcursor1 \
    libxi6 libxkbcommon-x11-0";
const NO_GPU: &str = "Install a Vulkan driver, hardware or software. On Debian and Ubuntu: \
    apt-get install mesa-vulkan-drivers";

/// Tries in a child process.
///
/// # Errors
/// [`Unavailable`] with the reason.
pub fn check(need: Need) -> Result<(), Unavailable> {
    if need == Need::Window && cfg!(target_os = "linux") {
        let variables = ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"];
        let set = |name: &&str| std::env::var_os(name).is_some_and(|v| !v.is_empty());
        if !variables.iter().any(set) {
            return Err(no_display(
                "There is no display: neither DISPLAY nor WAYLAND_DISPLAY is set.",
            ));
        }
    }
    let what = match need {
        Need::Window => "window",
        Need::Gpu => "gpu",
    };
    let child = std::env::current_exe().and_then(|path| {
        Command::new(path)
            .args(["--probe", what])
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .env("RUST_BACKTRACE", "0")
            .spawn()
    });
    // If the child process cannot be started, the game tries anyway.
    let Ok(mut child) = child else {
        return Ok(());
    };
    let start = Instant::now();
    while let Ok(None) = child.try_wait() {
        if start.elapsed() > PATIENCE {
            // A display that accepts the connection and never responds.
            let _ = child.kill();
            let _ = child.wait();
            return Err(no_display(&format!(
                "The display did not answer within {} s.",
                PATIENCE.as_secs()
            )));
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    match child.wait_with_output() {
        Ok(output) if !output.status.success() => {
            Err(explain(&String::from_utf8_lossy(&output.stderr)))
        }
        _ => Ok(()),
    }
}

fn no_display(reason: &str) -> Unavailable {
    Unavailable {
        reason: reason.to_owned(),
        advice: NO_DISPLAY,
    }
}

/// Converts the last output of the child into a reason and an advice.
fn explain(words: &str) -> Unavailable {
    let reason = words
        .lines()
        .map(str::trim)
        .rfind(|line| !line.is_empty() && !line.starts_with("note:"))
        .unwrap_or("The display could not be opened.")
        .to_owned();
    let lower = words.to_lowercase();
    let advice = if lower.contains("adapter") || lower.contains("gpu") || lower.contains("vulkan") {
        NO_GPU
    } else if lower.contains("library") || lower.contains(".so") {
        NO_LIBRARY
    } else {
        NO_DISPLAY
    };
    Unavailable { reason, advice }
}

/// Runs in the child: opens the required parts, or returns the reason for a failure. Panics of the libraries end the
/// process with their message, which also serves as a reason.
pub fn probe(need: Need) -> Result<(), String> {
    if need == Need::Window {
        winit::event_loop::EventLoop::new()
            .map_err(|e| format!("The display could not be opened: {e}"))?;
    }
    let instance =
        wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let options = wgpu::RequestAdapterOptions::default();
    bevy::tasks::block_on(instance.request_adapter(&options))
        .map(|_| ())
        .map_err(|e| format!("There is no GPU and no software driver (no Vulkan adapter): {e}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_and_advice() {
        const LIBRARY: &str = "libxkbcommon-x11.so.0: cannot open shared library";
        const GPU: &str = "There is no GPU (no Vulkan adapter)";
        const DISPLAY: &str = "Failed to open display";
        for (words, reason, advice) in [
            (
                &*format!("thread main panicked\n  {LIBRARY}\n"),
                LIBRARY,
                NO_LIBRARY,
            ),
            (GPU, GPU, NO_GPU),
            (
                &format!("{DISPLAY}\nnote: run with RUST_BACKTRACE=1"),
                DISPLAY,
                NO_DISPLAY,
            ),
            ("", "The display could not be opened.", NO_DISPLAY),
        ] {
            let said = explain(words);
            assert_eq!((&*said.reason, said.advice), (reason, advice));
        }
    }
}
