// The Charlie lobe (sheen), (2 s)^p (1 - 2 s) with p at least 1/2, with intervals for cells of energy.
// Derived in crates/core/src/lobe/profiles.rs. Reads `Kernel` and `Interval` of kernel.wgsl.

// Whether the pipeline serves Charlie instead of the other lobes: neither carries the code of the other.
override SHEEN: bool = false;

// Value lost where x^p is below the range of `power`.
const NOTHING = 1e-30f;
// Below it, quotients by powers of x leave the range of float32.
const MIN_X = 1e-12f;
// Error of s over the distance: distances are in error by 2^-21, s by half of that times the distance, and by
// four roundings.
const ERROR_OF_S = 1.06e-6f;

// x^p for x in [0, 2], below 1.1e-30 where it is below 2^-100. WGSL's pow, log2 and exp2 are in error by
// more.
fn power(x: f32, p: f32) -> f32 {
    // x = 2^whole m, with m within a factor of sqrt(2) of 1; log(m) by its series in (m - 1)/(m + 1).
    let bits = bitcast<u32>(x);
    let whole = bitcast<i32>(bits - 0x3f3504f3u) >> 23u;
    let m = bitcast<f32>(bits - (bitcast<u32>(whole) << 23u));
    let t = (m - 1.0) / (m + 1.0);
    let u = t * t;
    let series = t * (2.0 + u * (0.6666667 + u * (0.4 + u * (0.2857143 + u * 0.2222222))));
    let logarithm = f32(whole) + series * 1.442695;
    // 2^y, with the fraction of y by the exponential series.
    let y = max(p * logarithm, -120.0);
    let rounded = round(y);
    let z = (y - rounded) * 0.6931472;
    let cubic = 0.1666667 + z * (0.04166667 + z * (0.008333333 + z * (0.001388889 + z * 0.0001984127)));
    let fraction = 1.0 + z * (1.0 + z * (0.5 + z * cubic));
    return fraction * bitcast<f32>(u32(i32(rounded) + 127) << 23u);
}

fn charlie_value(kernel: Kernel, s: f32) -> f32 {
    return power(2.0 * s, kernel.first) * max(1.0 - 2.0 * s, 0.0);
}

// k'' / 4 at x = 2 s, with `rise` = x^p: p x^(p-2) (p - 1 - (p + 1) x).
fn charlie_bend(kernel: Kernel, x: f32, rise: f32) -> f32 {
    let p = kernel.first;
    let divisor = max(x, MIN_X);
    return p * rise * ((p - 1.0) - (p + 1.0) * x) / (divisor * divisor);
}

// |k'''|/24, with the factor that vanishes kept away from zero.
fn charlie_third(kernel: Kernel, s: f32) -> f32 {
    let p = kernel.first;
    let x = max(2.0 * s, MIN_X);
    let third = p * (p - 1.0) * power(x, p) * (abs((p - 2.0) - (p + 1.0) * x) + 1.0);
    return abs(third / (3.0 * x * x * x));
}

fn charlie_spread(kernel: Kernel, low: f32, high: f32) -> f32 {
    let peak = 0.5 * kernel.first / (kernel.first + 1.0);
    let least = min(charlie_value(kernel, low), charlie_value(kernel, high));
    return charlie_value(kernel, clamp(peak, low, high)) - least;
}

fn charlie_worst_distance(kernel: Kernel, near: f32, far: f32) -> f32 {
    return select(clamp(1.4142135, near, far), near, kernel.first < 2.0 && far < 1.0);
}

fn charlie_interval(kernel: Kernel, squared: f32, trace: f32, along: f32, radius: f32) -> Interval {
    let p = kernel.first;
    let distance = sqrt(squared);
    let near = max(distance - radius, 0.0);
    let far = distance + radius;
    let low = 0.25 * near * near;
    let high = min(0.25 * far * far, 1.0);
    let s = min(0.25 * (squared + trace), high);
    let a = 2.0 * low;
    let b = 2.0 * high;
    let t = 2.0 * s;
    let rise_a = power(a, p);
    let rise_b = power(b, p);
    let rise_t = power(t, p);
    let at_a = rise_a * max(1.0 - a, 0.0);
    let at_b = rise_b * max(1.0 - b, 0.0);
    let peak = p / (p + 1.0);
    let crest = select(max(at_a, at_b), kernel.second, a < peak && peak < b);
    let trough = min(at_a, at_b);

    let tangential = sqrt(max(along, 0.0));
    let radial = 0.5 * sqrt(max(trace, 0.0)) * radius;
    let most = 0.25 * (tangential + radial) * (tangential + radial);
    let inside = max(tangential - radial, 0.0);
    let smallest = 0.25 * inside * inside;
    // The bend is extreme at an end or where its own slope vanishes.
    let bend_a = charlie_bend(kernel, a, rise_a);
    let bend_b = charlie_bend(kernel, b, rise_b);
    let turning = select(bend_a, kernel.fourth, a < kernel.third && kernel.third < b);
    let steepest = 2.0 * max(max(bend_a, bend_b), turning);
    let flattest = 2.0 * min(min(bend_a, bend_b), turning);
    let at_mean = rise_t * (1.0 - t);
    let upper = at_mean + steepest * select(smallest, most, steepest > 0.0);
    let lower = at_mean + flattest * select(most, smallest, flattest > 0.0);
    let beyond = s - 0.5;
    // The sum cancels in front of the horizon.
    let excess = sqrt(most + beyond * beyond) + beyond + 5e-7;
    let over = select(0.0, rise_b * excess, b > 1.0);
    let under = max(2.0 * beyond, 0.0);
    // The second derivative is unbounded at s = 0.
    let sharp = a > MIN_X;
    let greatest = max(select(crest, min(crest, upper + over), sharp), 0.0) + NOTHING;
    let least = clamp(select(trough, max(trough, lower + under), sharp) - NOTHING, 0.0, greatest);

    let half_width = 0.866 * tangential;
    let in_front = select(share_in_front(-beyond, half_width), 1.0, b <= 1.0);
    let across = max(half_width - abs(beyond), 0.0);
    let gain = 2.0 * across * across / max(4.0 * half_width, 1e-6);
    // Beyond the horizon k is 0, and as steep and bent as at it.
    let front = clamp(t, 1e-6, 1.0);
    let rise = min(rise_t, 1.0);
    let bend = 2.0 * charlie_bend(kernel, front, rise) * in_front;
    let slope = 2.0 * rise * (p - (p + 1.0) * front) / front + 2.0 * (1.0 - in_front);
    let estimate = clamp(max(at_mean, 0.0) + 0.25 * bend * along + gain, least, greatest);
    // The slope up to the horizon, where rise_t is 1; leaves beyond it have none.
    let steepness = 2.0 * rise * abs(p / clamp(t, MIN_X, 1.0) - (p + 1.0));
    let rounding = select(ERROR_OF_S * distance * steepness, 0.0, distance - radius > 1.415);
    let spread = 0.5 * (crest - trough);
    // In front of the horizon, the series' error is that of its bend.
    let farther = max(s - low, high - s);
    let radial_part =
        0.25 * max(abs(steepest), abs(flattest)) * radius * radius * radius * (distance + 0.25 * radius);
    let rest = 0.5 * (steepest - flattest) * farther * farther + radial_part + rounding;
    let known = sharp && b <= 1.0;
    return Interval(least, greatest, estimate, slope, bend, select(3e38, rest, known), spread, rounding);
}
