// One value out of those of a workgroup's invocations. Halves are combined with halves, always in the same
// order, so that float sums are the same in every run. What includes this has GROUP_SIZE invocations, a power
// of two, and declares the type `Reduced` and combine(a: Reduced, b: Reduced) -> Reduced.

var<workgroup> reduced: array<Reduced, GROUP_SIZE>;

// The values `own` of all invocations combined, for all of them.
fn reduce(own: Reduced, lane: u32) -> Reduced {
    // An earlier result may still be read.
    workgroupBarrier();
    reduced[lane] = own;
    for (var step = GROUP_SIZE / 2u; step > 0u; step /= 2u) {
        workgroupBarrier();
        if lane < step {
            reduced[lane] = combine(reduced[lane], reduced[lane + step]);
        }
    }
    workgroupBarrier();
    return reduced[0];
}
