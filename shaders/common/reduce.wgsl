// Reduces the values of a workgroup's invocations to one. Halves are combined with halves in a fixed order,
// so that float sums are the same in every run. The including file has GROUP_SIZE invocations, a power of
// two, and declares the type `Reduced` and combine(a: Reduced, b: Reduced) -> Reduced.

var<workgroup> reduced: array<Reduced, GROUP_SIZE>;

// Combines the values `own` of all invocations and returns the result to each.
fn reduce(own: Reduced, lane: u32) -> Reduced {
    return reduce_part(own, lane, GROUP_SIZE);
}

// The same of parts of so many invocations, a power of two.
fn reduce_part(own: Reduced, lane: u32, part: u32) -> Reduced {
    // Wait until an earlier result has been read.
    workgroupBarrier();
    reduced[lane] = own;
    let within = lane % part;
    for (var step = part / 2u; step > 0u; step /= 2u) {
        workgroupBarrier();
        if within < step {
            reduced[lane] = combine(reduced[lane], reduced[lane + step]);
        }
    }
    workgroupBarrier();
    return reduced[lane - within];
}
