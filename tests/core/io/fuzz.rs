//! Mutated inputs: every reader returns an environment or an error, in limited time and memory.

use octagloss_fixtures::common::sweep;
use octagloss_fixtures::files::mutation;
use std::process::Command;
use std::time::Duration;

/// Measures peaks in a separate process, because the whole suite shares one allocator.
#[test]
fn mutated_inputs_neither_panic_nor_hang_nor_swell() {
    let output = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "io::fuzz::mutated_inputs_alone", "--ignored", "--nocapture", "--test-threads=1"])
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}");
    assert!(text.contains("1 passed"), "the inner test must have run: {text}");
    assert!(!text.contains("panicked at"), "a contained panic must not print: {text}");
}

/// Not a test of its own: the test above starts it where no other test allocates.
#[test]
#[ignore = "run by mutated_inputs_neither_panic_nor_hang_nor_swell, in a separate process"]
fn mutated_inputs_alone() {
    let folder = tempfile::tempdir().unwrap();
    for reader in mutation::readers(folder.path()) {
        let count = sweep(1_000, 5_000);
        let tally = mutation::fuzz(&reader, count, &crate::MEMORY);
        assert_eq!(tally.mutations, count, "{}: all were tried", reader.name);
        assert_eq!(
            tally.errors + tally.reads,
            count,
            "{}: each must end in an error or an environment",
            reader.name
        );
        assert!(tally.errors > count / 10, "{}: mutations must cause errors: {tally:?}", reader.name);
        assert!(tally.holds(), "{}: {tally:?}", reader.name);
    }
}

/// The tally must be able to fail.
#[test]
fn tally_detects_panics_slowness_and_swelling() {
    let good = || mutation::Tally {
        mutations: 1,
        errors: 1,
        reads: 0,
        panics: 0,
        slowest: Duration::from_millis(1),
        peak_bytes: 1000,
    };
    assert!(good().holds(), "the good tally holds");
    assert!(!mutation::Tally { panics: 1, ..good() }.holds(), "a panic");
    assert!(!mutation::Tally { slowest: Duration::from_secs(3), ..good() }.holds(), "slow");
    assert!(!mutation::Tally { peak_bytes: mutation::PEAK_LIMIT + 1, ..good() }.holds(), "large");
}

#[test]
fn allocator_counts() {
    use peakmem_alloc::PeakMemAllocTrait as _;
    crate::MEMORY.reset_peak_memory();
    std::hint::black_box(vec![0u8; 50 << 20]);
    assert!(crate::MEMORY.get_peak_memory() > 40 << 20, "the allocator must count fifty megabytes");
}
