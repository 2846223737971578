// Prefix sums over a workgroup's invocations (Hillis and Steele 1986). The including file has GROUP_SIZE
// invocations and declares the type `Scanned`, whose zero value is the neutral element, and
// add_scanned(a: Scanned, b: Scanned) -> Scanned.

var<workgroup> scanned: array<Scanned, GROUP_SIZE>;

// Sum of the values `own` of the invocations before `lane`.
fn sum_before(own: Scanned, lane: u32) -> Scanned {
    scanned[lane] = own;
    for (var step = 1u; step < GROUP_SIZE; step *= 2u) {
        workgroupBarrier();
        var left = Scanned();
        if lane >= step {
            left = scanned[lane - step];
        }
        workgroupBarrier();
        scanned[lane] = add_scanned(left, scanned[lane]);
    }
    workgroupBarrier();
    if lane == 0u {
        return Scanned();
    }
    return scanned[lane - 1u];
}
