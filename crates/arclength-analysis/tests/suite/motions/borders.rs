//! Motions that reach a border at which the field ends: roots of parts that are cut off, against closed forms.

use super::history::{History, close};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// A tank runs empty (Torricelli), however its outflow is written, and stays so.
    #[test]
    fn a_tank_runs_empty(power in 0.3_f64..0.8, rate in 0.2_f64..3.0, height in 0.1_f64..4.0, part in 0.2_f64..2.0) {
        let empty = height.powf(1.0 - power) / ((1.0 - power) * rate);
        let time = part * empty;
        let right = if part < 1.0 { height * (1.0 - part).powf(1.0 / (1.0 - power)) } else { 0.0 };
        for outflow in [
            format!("max(h,0)^{power}"),
            format!("sign(h)*abs(h)^{power}"),
            format!("if(h>0)then(h^{power})else(0)"),
        ] {
            let end = History::of(&format!("h'=-{rate}*{outflow}\ninit h={height}\n"), time, 2).end();
            close(&end[1..], &[right], 1e-8);
        }
    }

    /// A root that begins and ends twice in a turn; its integral over a turn is one of the lemniscate.
    #[test]
    fn a_root_of_a_part_that_is_cut_off(turns in 1_u32..6, frequency in 0.3_f64..3.0) {
        const OVER_A_TURN: f64 = 2.396_280_469_471_184_4;
        let text = format!("x'=-{frequency}*y\ny'={frequency}*x\nz'=sqrt(max(x,0))\ninit x=0,y=-1\n");
        let end = History::of(&text, f64::from(turns) * std::f64::consts::TAU / frequency, 2).end();
        close(&end[3..], &[f64::from(turns) * OVER_A_TURN / frequency], 1e-8);
    }
}
