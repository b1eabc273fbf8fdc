//! The one error type of the crate, and why Newton's method fails.

use crate::integration::IntegrationError;

/// Why a correction failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CorrectionFailure {
    /// The bordered Jacobian is singular.
    #[error("the Jacobian is singular")]
    Singular,
    /// An update was not finite: the vector field was evaluated outside its domain.
    #[error("the vector field is not finite there")]
    NotFinite,
    /// The vector field is finite, but an event or a border that the cycle has to come to is not passed close to where it was.
    #[error("an event, a border or the end of a slide that the cycle passed before is passed no more")]
    GateMissed,
    /// The vector field has a value, but its derivatives have none, as at the tip of a cone.
    #[error("the vector field has no derivatives there")]
    NotDifferentiable,
    /// The updates did not become smaller.
    #[error("Newton's method does not converge")]
    Diverged,
}

/// What can go wrong in a computation of this crate.
#[derive(Debug, Clone, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Newton's method did not find the solution asked for.
    #[error("no {sought} found from the start given: {cause}; try a start closer to it")]
    NotFound {
        /// What was sought: "equilibrium", "limit cycle", "Hopf point" and so on.
        sought: &'static str,
        /// Why the corrector gave up.
        #[source]
        cause: CorrectionFailure,
    },
    /// Two branches pass each other closely, and a step led from one to the other; it is made anew and shorter.
    #[error("two branches pass each other closely, and a step led from one to the other; take shorter steps")]
    OtherBranch,
    /// Eigenvalues or multipliers did not converge.
    #[error(
        "the {quantity} could not be computed: the matrix has entries that are not finite, or the iteration did not converge"
    )]
    Eigenvalues {
        /// "eigenvalues" or "Floquet multipliers".
        quantity: &'static str,
    },
    /// The mesh would need more intervals than allowed.
    #[error(
        "the cycle needs more than {limit} mesh intervals (error estimate {error_estimate:e}); \
         raise the limit or the tolerance"
    )]
    MeshLimit {
        /// Most intervals allowed.
        limit: usize,
        /// Error estimate on the finest mesh tried.
        error_estimate: f64,
    },
    /// A motion did not come back to its start.
    #[error(
        "the motion does not come back to its start within the time {duration}: it has not settled on a cycle, or the cycle is \
         longer; follow it longer first{}",
        drift(drifting)
    )]
    NoReturn {
        /// Time for which it was followed.
        duration: f64,
        /// States that move on and on in one direction, as angles that turn do.
        drifting: Vec<String>,
    },
    /// A motion comes to rest.
    #[error(
        "the motion comes to rest at the equilibrium ({}): there is no cycle to start from; start from a motion that goes on swinging",
        equilibrium.iter().map(|value| crate::numbers::readable(*value)).collect::<Vec<_>>().join(", ")
    )]
    Resting {
        /// The equilibrium.
        equilibrium: Vec<f64>,
    },
    /// A start of a branch of cycles has one more multiplier at one than that of time, and Newton's method does not converge.
    #[error(
        "no single cycle is found from the start given, which has {count} more {} within {distance} of one than that of time: it \
         may belong to a family of cycles for one and the same value of the parameter. Where a symmetry turns or shifts the \
         states, take coordinates that it does not move, such as moduli and differences of phases; where a quantity is conserved, \
         put it into a parameter",
        if *count == 1 { "multiplier" } else { "multipliers" }
    )]
    FamilyOfCycles {
        /// Why the corrector gave up.
        #[source]
        cause: CorrectionFailure,
        /// How many multipliers other than the trivial one are near one.
        count: usize,
        /// How near they are.
        distance: f64,
    },
    /// A motion could not be computed.
    #[error("the motion that the cycle is to be taken from cannot be computed")]
    Motion(#[from] IntegrationError),
    /// A cycle passes more borders between the pieces of its field than are followed.
    #[error(
        "the cycle passes more than {limit} borders at which the field switches: it slides along one of them, or nearly so, which \
         is not followed"
    )]
    TooManyBorders {
        /// Most borders.
        limit: usize,
    },
    /// The start of a branch passes the condition of an event, but its state does not jump there.
    #[error(
        "the start passes the condition of event {event} without the jump: it is no cycle of this model; start from the end of a \
         motion that has settled on a cycle, or from a cycle of an earlier result"
    )]
    EventWithoutJump {
        /// Number of the event, counted from one.
        event: usize,
    },
    /// Along a curve of special cycles the borders change that the cycles pass.
    #[error(
        "from here on the cycles pass other borders at which the field switches: start once more from a special cycle beyond"
    )]
    BordersChange,
    /// A branch point does not persist when a second parameter varies.
    #[error(
        "the branch point breaks up when the second parameter varies; a curve of branch points exists where symmetry, or a \
         state that stays zero, keeps them"
    )]
    BranchPointBreaksUp,
    /// A setting or start value is outside what is allowed.
    #[error("{name} = {value} is not allowed: {allowed}")]
    Invalid {
        /// What was given.
        name: String,
        /// Its value.
        value: String,
        /// What is allowed.
        allowed: String,
    },
}

/// Parts of a motion, behind its first quarter, over which a state that drifts moves alike: the smallest change is this part of the largest
/// at least, and their sum this part of all that it moves.
const DRIFT_PARTS: usize = 6;
const ALIKE: f64 = 0.5;

impl Error {
    /// A motion, of which the states at equal times are given, did not come back to its start in this time.
    pub fn no_return<S: AsRef<[f64]>>(duration: f64, names: &[String], states: &[S]) -> Self {
        let behind = &states[states.len() / 4..];
        let drifts = |index: usize| {
            let values: Vec<f64> = behind.iter().map(|state| state.as_ref()[index]).collect();
            let at = |part: usize| values[part * (values.len() - 1) / DRIFT_PARTS];
            let changes: Vec<f64> = (0..DRIFT_PARTS).map(|part| at(part + 1) - at(part)).collect();
            let smallest = changes.iter().map(|change| change.abs()).fold(f64::INFINITY, f64::min);
            let largest = changes.iter().map(|change| change.abs()).fold(0.0, f64::max);
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let is_one_way = changes.iter().all(|change| change * changes[0] > 0.0);
            let moved = changes.iter().sum::<f64>().abs();
            is_one_way && smallest > ALIKE * largest && moved > ALIKE * (high - low)
        };
        let moving =
            names.iter().enumerate().filter(|(index, _)| behind.len() > DRIFT_PARTS && drifts(*index));
        Self::NoReturn { duration, drifting: moving.map(|(_, name)| name.clone()).collect() }
    }
}

fn drift(drifting: &[String]) -> String {
    if drifting.is_empty() {
        return String::new();
    }
    let moves = if drifting.len() == 1 { "moves" } else { "move" };
    format!(
        ", but {} {moves} on and on in one direction, which no cycle does: of an angle take the sine and the cosine as states",
        drifting.join(", ")
    )
}
