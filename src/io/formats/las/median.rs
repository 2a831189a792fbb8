//! The running median by which LAZ predicts the next step.

/// Running median of five values. A new value replaces the largest or the smallest, alternately: when it falls into the
/// half from which one was dropped, the next is dropped from the other half.
#[derive(Debug, Clone, Copy)]
pub(super) struct Median {
    sorted: [i32; 5],
    drops_largest: bool,
}

impl Default for Median {
    fn default() -> Self {
        Self {
            sorted: [0; 5],
            drops_largest: true,
        }
    }
}

impl Median {
    pub(super) fn get(self) -> i32 {
        self.sorted[2]
    }

    pub(super) fn add(&mut self, value: i32) {
        let median = self.get();
        let mut rest = value;
        if self.drops_largest {
            for place in &mut self.sorted[..4] {
                (*place, rest) = (rest.min(*place), rest.max(*place));
            }
            self.sorted[4] = rest;
            self.drops_largest = value < median;
        } else {
            for place in self.sorted[1..].iter_mut().rev() {
                (*place, rest) = (rest.max(*place), rest.min(*place));
            }
            self.sorted[0] = rest;
            self.drops_largest = value <= median;
        }
    }
}
