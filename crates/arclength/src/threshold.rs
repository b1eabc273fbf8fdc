//! Where switch functions of a field that is smooth piece by piece pass from one piece to the next.

/// Where a switch function passes from one cell to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Threshold {
    /// At zero: the cells are -1 below and 1 above it.
    Zero,
    /// At every whole number: a cell is named by the one at its lower end.
    Whole,
}

impl Threshold {
    /// The cell in which a value of the switch function lies; at a threshold the upper one.
    pub fn cell(self, value: f64) -> f64 {
        match self {
            Self::Zero if value < 0.0 => -1.0,
            Self::Zero => 1.0,
            Self::Whole => value.floor(),
        }
    }

    /// Lower and upper border of a cell.
    pub fn borders(self, cell: f64) -> [f64; 2] {
        match self {
            Self::Zero if cell < 0.0 => [f64::NEG_INFINITY, 0.0],
            Self::Zero => [0.0, f64::INFINITY],
            Self::Whole => [cell, cell + 1.0],
        }
    }

    /// The cell beyond the upper border of a cell, or beyond its lower one.
    pub fn next(self, cell: f64, upwards: bool) -> f64 {
        match (self, upwards) {
            (Self::Zero, true) => 1.0,
            (Self::Zero, false) => -1.0,
            (Self::Whole, true) => cell + 1.0,
            (Self::Whole, false) => cell - 1.0,
        }
    }
}
