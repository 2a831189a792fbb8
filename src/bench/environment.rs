//! Hardware and build of a measurement.

use crate::render::AnyRenderer;
use crate::render::gpu::Context;

/// The machine and the program of a measurement.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Environment {
    /// Version of this program.
    pub version: &'static str,
    /// True when the program was compiled without optimisation or with debug assertions: its CPU times mean little.
    pub is_debug_build: bool,
    /// Name, type and driver of the adapter; where there is none, the software renderer.
    pub adapter: String,
    /// True if the adapter measures GPU time with timestamp queries.
    pub has_timestamps: bool,
    /// Model of the CPU, or its architecture where the system does not name it.
    pub cpu: String,
    /// Threads that the system offers.
    pub threads: usize,
    /// Operating system.
    pub system: &'static str,
}

impl Environment {
    /// Detects the environment of this program, drawing with `context` or without any driver.
    pub fn detect(context: Option<&Context>) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            is_debug_build: cfg!(debug_assertions),
            adapter: context.map_or_else(|| AnyRenderer::cpu().summary(), Context::adapter_summary),
            has_timestamps: context.is_some_and(|context| context.has_timestamps),
            cpu: Self::cpu(),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            system: std::env::consts::OS,
        }
    }
}

impl Environment {
    /// See [`Environment::cpu`](#structfield.cpu).
    pub(super) fn cpu() -> String {
        std::fs::read_to_string("/proc/cpuinfo")
            .ok()
            .and_then(|text| cpu_model(&text))
            .unwrap_or_else(|| std::env::consts::ARCH.to_owned())
    }
}

/// The model in Linux's `/proc/cpuinfo`.
fn cpu_model(cpuinfo: &str) -> Option<String> {
    let line = cpuinfo.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::cpu_model;

    #[test]
    fn the_cpu_model_is_read_if_available() {
        let text = "processor\t: 0\nmodel name\t: Some CPU @ 2.60GHz\nmodel name\t: other\n";
        assert_eq!(cpu_model(text).as_deref(), Some("Some CPU @ 2.60GHz"));
        assert_eq!(cpu_model("processor : 0\nFeatures : fp asimd\n"), None);
    }
}
