//! Options of what is monitored along a branch.

use arclength_analysis::Monitored;
use clap::Args;

/// What is recorded along a branch, and where it ends for that.
#[derive(Args, Debug)]
pub struct MonitorOptions {
    /// Record an expression along the branch or curve, and give points where it has these values; on cycles with max(..), min(..),
    /// mean(..), at(.., PHASE), period and parameters, such as "max(x)-min(x)=1,2"; the phase from 0 to 1 is counted from
    /// the place where the first state is largest
    #[arg(long, value_name = "EXPRESSION[=A,B,..]", allow_hyphen_values = true)]
    monitor: Vec<Monitored>,

    /// End the branch or curve where an expression has a value, such as period=50
    #[arg(long, value_name = "EXPRESSION=A", allow_hyphen_values = true)]
    until: Vec<Monitored>,
}

impl MonitorOptions {
    /// What is asked for.
    pub fn asked(&self) -> Vec<Monitored> {
        self.monitor.iter().cloned().chain(self.until.iter().cloned().map(Monitored::ending)).collect()
    }
}
