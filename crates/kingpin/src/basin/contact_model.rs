//! Whether motions that are told apart may slide.

/// Whether the wheel is allowed to slide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactModel {
    /// It rolls whatever force that takes.
    Rolling,
    /// Coulomb friction: it slides where rolling takes more than the static friction.
    Sliding,
}

impl ContactModel {
    /// Name as it is written in options and results.
    pub const fn name(self) -> &'static str {
        match self {
            ContactModel::Rolling => "rolling",
            ContactModel::Sliding => "sliding",
        }
    }
}
