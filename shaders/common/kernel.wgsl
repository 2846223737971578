// Lobes as kernels of s = |l - R|^2/4, with intervals for cells of energy. Derived in
// crates/core/src/lobe/radial.rs and crates/core/src/cpu/adaptive.rs.
#include "common/charlie.wgsl"

const SHAPE_GGX = 0u;
const SHAPE_PHONG = 1u;
const SHAPE_WIDE_PHONG = 2u;
const SHAPE_CONE = 3u;
const SHAPE_COSINE = 4u;

struct Kernel {
    shape: u32,
    // Peak of GGX, exponent of Phong, edge of the cone, power of Charlie.
    first: f32,
    // Steepness of GGX, greatest value of Charlie.
    second: f32,
    // Where the slope of Charlie's bend vanishes, and the bend there.
    third: f32,
    fourth: f32,
}

fn is_smooth(kernel: Kernel) -> bool {
    return SHEEN || kernel.shape == SHAPE_GGX || kernel.shape == SHAPE_PHONG || kernel.shape == SHAPE_COSINE;
}

// ln(1 + x) for -1 < x <= 0. WGSL's log is in error by 2^-21 near 1.
fn log_1p(x: f32) -> f32 {
    if x < -0.5 {
        return log(1.0 + x);
    }
    // 2 artanh(x / (2 + x)); the first omitted term is below 3^-19/19.
    let y = x / (2.0 + x);
    let z = y * y;
    var sum = 0.0;
    for (var k = 17; k > 0; k -= 2) {
        sum = sum * z + 1.0 / f32(k);
    }
    return 2.0 * y * sum;
}

fn value(kernel: Kernel, s: f32) -> f32 {
    switch kernel.shape {
        case SHAPE_GGX: {
            let w = 1.0 / (1.0 + kernel.second * s);
            return kernel.first * w * w * max(1.0 - 2.0 * s, 0.0);
        }
        case SHAPE_PHONG, SHAPE_WIDE_PHONG: {
            if s >= 0.5 {
                return 0.0;
            }
            return exp(kernel.first * log_1p(-2.0 * s));
        }
        case SHAPE_CONE: {
            return select(0.0, 1.0, s <= kernel.first);
        }
        default: {
            return max(1.0 - 2.0 * s, 0.0);
        }
    }
}

// k' in front of the horizon, where k is `value`; for smooth lobes but Charlie.
fn slope(kernel: Kernel, s: f32, value: f32) -> f32 {
    switch kernel.shape {
        case SHAPE_GGX: {
            let w = 1.0 / (1.0 + kernel.second * s);
            return -2.0 * kernel.first * w * w * (1.0 + kernel.second * w * (1.0 - 2.0 * s));
        }
        case SHAPE_PHONG: {
            return -2.0 * kernel.first * value / max(1.0 - 2.0 * s, 1e-3);
        }
        case SHAPE_COSINE: {
            return -2.0;
        }
        default: {
            return 0.0;
        }
    }
}

// k'' in front of the horizon.
fn curvature(kernel: Kernel, s: f32) -> f32 {
    switch kernel.shape {
        case SHAPE_GGX: {
            let w = 1.0 / (1.0 + kernel.second * s);
            let steep_w = kernel.second * w;
            return kernel.first * w * w * steep_w * (8.0 + 6.0 * steep_w * (1.0 - 2.0 * s));
        }
        case SHAPE_PHONG: {
            let cosine = max(1.0 - 2.0 * s, 1e-3);
            return 4.0 * kernel.first * (kernel.first - 1.0) * value(kernel, s) / (cosine * cosine);
        }
        default: {
            return 0.0;
        }
    }
}

// Greatest |dk/ds| from s = 1/4 to the horizon, for lobes that are smooth there; Charlie's intervals state
// their own rounding.
fn grazing_slope(kernel: Kernel) -> f32 {
    switch kernel.shape {
        case SHAPE_GGX: {
            let w = 1.0 / (1.0 + 0.25 * kernel.second);
            return kernel.first * w * w * (2.0 + kernel.second * w);
        }
        case SHAPE_PHONG: {
            return 2.0 * kernel.first * exp2(1.0 - kernel.first);
        }
        case SHAPE_COSINE: {
            return 2.0;
        }
        default: {
            return 0.0;
        }
    }
}

// Jump of k' at the horizon.
fn kink(kernel: Kernel) -> f32 {
    switch kernel.shape {
        case SHAPE_GGX: {
            let w = 1.0 / (1.0 + 0.5 * kernel.second);
            return 2.0 * kernel.first * w * w;
        }
        case SHAPE_COSINE: {
            return 2.0;
        }
        default: {
            return 0.0;
        }
    }
}

// Length scale of k around s; 0 where k is not smooth.
fn scale(kernel: Kernel, s: f32) -> f32 {
    if SHEEN {
        return 2.88 * s / (1.0 + kernel.first);
    }
    switch kernel.shape {
        case SHAPE_GGX: {
            return s + 1.0 / max(kernel.second, 1e-6);
        }
        case SHAPE_PHONG: {
            return 1.44 * max(1.0 - 2.0 * s, 1e-3) / kernel.first;
        }
        case SHAPE_COSINE: {
            return 1e12;
        }
        default: {
            return 0.0;
        }
    }
}

// |k'''|/24 around `s`, where k is `value`, times the third moment `variance` times `reach`.
fn third_order(kernel: Kernel, s: f32, value: f32, variance: f32, reach: f32) -> f32 {
    if SHEEN {
        return charlie_third(kernel, s) * variance * reach;
    }
    let length_scale = scale(kernel, s);
    return value * variance * (reach / length_scale) / (length_scale * length_scale);
}

fn worst_distance(kernel: Kernel, near: f32, far: f32) -> f32 {
    if kernel.shape == SHAPE_GGX {
        return clamp(1.2 / sqrt(kernel.second + 1.0), near, far);
    }
    if SHEEN {
        return charlie_worst_distance(kernel, near, far);
    }
    return near;
}

struct Interval {
    least: f32,
    greatest: f32,
    estimate: f32,
    // Slope and half the second derivative of k around the mean of s, faded out across the horizon; 0 for
    // lobes that are not smooth.
    slope: f32,
    bend: f32,
    // What light of zero total can add at most per unit of its variation: to the terms of `slope` and `bend`,
    // huge or not a number where the series is of no use, and without them.
    rest: f32,
    spread: f32,
    // Effect of an error of s, where `grazing_slope` does not count it.
    rounding: f32,
}

// The share in front of the horizon of energy spread evenly over `half_width` of s around a mean `before` it.
fn share_in_front(before: f32, half_width: f32) -> f32 {
    return clamp(0.5 + 0.5 * before / max(half_width, 1e-9), 0.0, 1.0);
}

fn interval(kernel: Kernel, squared: f32, trace: f32, along: f32, radius: f32) -> Interval {
    if SHEEN {
        return charlie_interval(kernel, squared, trace, along, radius);
    }
    let distance = sqrt(squared);
    let near = max(distance - radius, 0.0);
    let far = distance + radius;
    let low = 0.25 * near * near;
    let high = min(0.25 * far * far, 1.0);
    let s = 0.25 * (squared + trace);
    let at_mean = value(kernel, s);
    let k_near = value(kernel, low);
    let k_far = value(kernel, high);
    let spread = 0.5 * (k_near - k_far);
    if !is_smooth(kernel) {
        return Interval(k_far, k_near, at_mean, 0.0, 0.0, spread, spread, 0.0);
    }
    // s - low and high - s, computed without cancellation.
    let down = select(s, 0.25 * (radius * (2.0 * distance - radius) + trace), distance > radius);
    let up = max(0.25 * (radius * (2.0 * distance + radius) - trace), 1e-6 * down);
    let tangential = sqrt(max(along, 0.0));
    let radial = 0.5 * sqrt(max(trace, 0.0)) * radius;
    let most = 0.25 * (tangential + radial) * (tangential + radial);
    let inside = max(tangential - radial, 0.0);
    let smallest = 0.25 * inside * inside;
    // A point has no steps.
    let step_up = min(select(0.0, most / down, down > 0.0), up);
    let step_down = min(select(0.0, smallest / up, up > 0.0), down);
    // Split k into a hinge at the horizon and a smooth rest; a cell in front of the horizon needs no hinge.
    let below_horizon = high < 0.5;
    let jump = select(kink(kernel), 0.0, below_horizon);
    let inner = value(kernel, s + step_up) - hinge(jump, s + step_up);
    let outer = value(kernel, s - step_down) - hinge(jump, s - step_down);
    let nearest = k_near - hinge(jump, low);
    let farthest = k_far - hinge(jump, high);
    let span_up = down + step_up;
    let span_down = up + step_down;
    let share_up = select(0.0, step_up / span_up, span_up > 0.0);
    let share_down = select(0.0, step_down / span_down, span_down > 0.0);
    let before = 0.5 - s;
    let deviation = sqrt(min(most, down * up) + before * before);
    // Differences of hinges are rounded at the precision of the greater one.
    let rounding = 5e-7 * jump;
    let greatest = inner + share_up * (nearest - inner) + 0.5 * jump * (deviation + before) + rounding;
    let least = min(max(outer + share_down * (farthest - outer) + hinge(jump, s) - rounding, 0.0), greatest);
    // For energy spread evenly over s: its share in front of the horizon, and the gain from the kink.
    let half_width = 0.866 * tangential;
    let in_front = select(share_in_front(before, half_width), 1.0, below_horizon);
    let across = max(half_width - abs(before), 0.0);
    let gain = jump * across * across / max(4.0 * half_width, 1e-6);
    // Beyond the horizon k is 0, and as steep and bent as at it.
    let front = min(s, 0.5);
    let steepness = slope(kernel, front, at_mean);
    let curved = 0.5 * curvature(kernel, front);
    let bend = curved * in_front;
    let estimate = min(max(at_mean + 0.25 * bend * along + gain, least), greatest);
    // What k minus its series in front of the horizon loses over the reach; the terms that are used differ.
    let near_horizon = s >= 0.4995;
    let front_slope = select(steepness, 0.0, near_horizon);
    let front_bend = select(curved, 0.0, near_horizon);
    let falling = steepness + jump * (1.0 - in_front);
    let loss = k_near - k_far + front_slope * (down + up) + front_bend * (up * up - down * down);
    let farther = max(down, up);
    let differing = abs(falling - front_slope) * (down + up) + abs(bend - front_bend) * farther * farther;
    // The quadrupole leaves out the radial part of the variance.
    let radial_part = 0.25 * bend * radius * radius * radius * (distance + 0.25 * radius);
    let rest = 0.5 * (max(loss, 0.0) + differing) + jump * max(high - 0.5, 0.0) + radial_part + 5e-7 * k_near;
    return Interval(least, greatest, estimate, falling, bend, rest, spread, 0.0);
}

// Hinge at the horizon: slope -`bend` in front of it, 0 beyond.
fn hinge(bend: f32, s: f32) -> f32 {
    return bend * max(0.5 - s, 0.0);
}

// Variation of k from `distance` - `radius` to `distance` + `radius`.
fn spread_around(kernel: Kernel, distance: f32, radius: f32) -> f32 {
    let near = max(distance - radius, 0.0);
    let far = distance + radius;
    let low = 0.25 * near * near;
    let high = min(0.25 * far * far, 1.0);
    if SHEEN {
        return charlie_spread(kernel, low, high);
    }
    return value(kernel, low) - value(kernel, high);
}

// The greatest such variation of a lobe that is not smooth, at distances from `near` to `far`. A cone has one
// jump. A wide Phong lobe is steepest at an end, at the horizon, or where d (1 - d^2/2)^(n-1) is greatest.
fn widest_spread(kernel: Kernel, near: f32, far: f32, radius: f32) -> f32 {
    if kernel.shape == SHAPE_CONE {
        return first_order_width(kernel, 0.5 * (near + far), radius, 0.5 * (far - near));
    }
    let horizon = clamp(1.4142135, near, far);
    var steepest = horizon;
    if kernel.first > 1.0 {
        steepest = clamp(inverseSqrt(kernel.first - 0.5), near, far);
    }
    let ends = max(spread_around(kernel, near, radius), spread_around(kernel, far, radius));
    return max(ends, max(spread_around(kernel, horizon, radius), spread_around(kernel, steepest, radius)));
}

// Expected error of the estimate, to select the cells to split.
fn expected_error(kernel: Kernel, distance: f32, radius: f32, packet: f32, trace: f32) -> f32 {
    if !is_smooth(kernel) {
        return 0.25 * widest_spread(kernel, max(distance - packet, 0.0), distance + packet, radius);
    }
    let worst = worst_distance(kernel, max(distance - packet, 0.0), distance + packet);
    let along = 0.6 * trace * worst * worst;
    let here = interval(kernel, worst * worst, trace, along, radius);
    let s = 0.25 * (worst * worst + trace);
    let reach = 0.25 * radius * (2.0 * worst + radius);
    let near = max(distance - packet - radius, 0.0);
    let far = distance + packet + radius;
    let over = max(min(0.25 * far * far - 0.5, 0.5 - 0.25 * near * near), 0.0);
    // Charlie's error from the kink is not estimated separately.
    if reach >= 0.5 * scale(kernel, s) || (SHEEN && over > 0.0) {
        return 0.25 * (here.greatest - here.least);
    }
    let squares = 0.25 * (along + 0.25 * trace * radius * radius);
    let third = third_order(kernel, s, here.estimate, squares, reach);
    let variance = 0.25 * trace * distance * distance;
    let apart = max(abs(0.5 - 0.25 * (distance * distance + trace)) - 0.5 * distance * packet, 0.0);
    let bent = kink(kernel) * min(0.5 * variance / max(sqrt(variance + apart * apart) + apart, 1e-12), over);
    return third + bent;
}

// Width of the interval for cells whose centroid is not known exactly.
fn first_order_width(kernel: Kernel, distance: f32, radius: f32, packet: f32) -> f32 {
    return spread_around(kernel, distance, radius + packet);
}
