//! Which probes a frame updates.

/// Takes turns within a budget.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Schedule {
    /// The probe that is next.
    next: usize,
    /// Time to update a probe, if measured.
    pub(super) seconds: Option<f64>,
}

impl Schedule {
    /// The probes, of `count`, that fit into `budget` seconds: at least one, and all without a budget. Before
    /// a measurement, one.
    pub(super) fn turn(&mut self, count: usize, budget: Option<f64>) -> Vec<usize> {
        let many = match (budget, self.seconds) {
            (None, _) => count,
            (Some(_), None) => 1,
            // Casts saturate.
            (Some(budget), Some(seconds)) => (budget / seconds.max(1e-9)) as usize,
        };
        let many = many.clamp(1, count.max(1)).min(count);
        let chosen = (0..many).map(|k| (self.next + k) % count).collect();
        self.next = (self.next + many) % count.max(1);
        chosen
    }
}

#[cfg(test)]
mod tests {
    use super::Schedule;

    #[test]
    fn probes_take_turns_within_the_budget() {
        let mut schedule = Schedule::default();
        assert_eq!(schedule.turn(3, None), [0, 1, 2]);
        assert_eq!(schedule.turn(3, Some(1.0)), [0], "not measured yet");
        schedule.seconds = Some(2e-3);
        assert_eq!(schedule.turn(3, Some(5e-3)), [1, 2], "two fit");
        assert_eq!(schedule.turn(3, Some(5e-3)), [0, 1]);
        assert_eq!(schedule.turn(3, Some(1e-3)), [2], "at least one");
        assert_eq!(schedule.turn(3, Some(1.0)), [0, 1, 2], "none twice");
        assert_eq!(schedule.turn(0, Some(1.0)), [0; 0]);
        assert_eq!(schedule.turn(2, Some(f64::INFINITY)), [0, 1]);
    }
}
