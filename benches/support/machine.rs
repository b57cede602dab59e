//! Says where the figures were made.

/// One line: processor, threads, instruction set the compiler was allowed, versions.
pub fn line() -> String {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let simd = if cfg!(target_feature = "avx2") { "AVX2" } else { "the target's baseline" };
    format!(
        "{}; {threads} threads; {} {}; compiled for {simd}; toon-raster {}, resvg {} (tiny-skia {}), vello_cpu {}",
        processor(),
        std::env::consts::OS,
        std::env::consts::ARCH,
        env!("CARGO_PKG_VERSION"),
        locked("resvg"),
        locked("tiny-skia"),
        locked("vello_cpu"),
    )
}

/// The processor's name where the system tells it, as Linux does.
fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info.lines().find_map(|line| line.strip_prefix("model name"));
    name.map_or("unknown processor".to_string(), |n| n.trim_start_matches([' ', '\t', ':']).to_string())
}

/// The version of a package that this program was built with.
fn locked(package: &str) -> &'static str {
    let lock = include_str!("../../Cargo.lock");
    let entry = format!("name = \"{package}\"\nversion = \"");
    lock.split_once(&entry).and_then(|(_, rest)| rest.split('"').next()).unwrap_or("?")
}
