//! The field in a region is the field, and goes on smoothly beyond the region's borders.

use arclength::pieces::{Border, Pieces};
use arclength::{Threshold, VectorField};
use arclength_ode::Model;
use proptest::prelude::*;

const MODELS: [&str; 8] = [
    "par p=1\nx'=p-abs(x)+y\ny'=max(x,y)-min(x,2*y)\ndone\n",
    "par p=1\nx'=if(x>y)then(p)else(-x)\ny'=heav(x-p)*sign(y)\ndone\n",
    "par p=0.3\nx'=mod(x,p)+flr(y)\ny'=ceil(x*y)-x\ndone\n",
    "par p=2\nx'=abs(abs(x)-p)-y\ny'=max(min(x,p),-p)-abs(x-abs(y-max(x,p)))\ndone\n",
    "par p=2\nx'=if((x<p)&(y>=0))then(x^2)else(if(x<=y)then(1)else(y))\ny'=not(x>1)+(y<2)*x\ndone\n",
    "par p=2\nx'=if(heav(x)>0.5)then(-1)else(y)\ny'=(x>p)|(y<x)\ndone\n",
    "par p=2\nx'=sqrt(abs(x))*exp(-abs(y))\ny'=max(x,max(y,max(x+y,p)))\ndone\n",
    "par p=2\nf(a,b)=if(a!=b)then(a)else(b)\nx'=f(x,y)+(x==y)\ny'=mod(abs(x),2)-flr(flr(x)/2)+x\ndone\n",
];

proptest! {
    #[test]
    fn the_field_of_the_region_of_a_state_is_the_field(
        model in 0..MODELS.len(),
        x in -5.0..5.0_f64,
        y in -5.0..5.0_f64,
    ) {
        let model = Model::parse(MODELS[model]).unwrap();
        let parameters = model.default_parameters().to_vec();
        let pieces = Pieces::of(&model).unwrap();
        let region = pieces.region_at(&[x, y], &parameters);
        let (mut whole, mut piece) = ([0.0; 2], [0.0; 2]);
        let mut switches = vec![0.0; region.len()];
        model.evaluate(&[x, y], &parameters, &mut whole);
        pieces.evaluate(&region, &[x, y], &parameters, &mut piece, &mut switches);
        for (a, b) in whole.iter().zip(piece) {
            prop_assert!((a - b).abs() <= 1e-14 * a.abs().max(1.0), "{whole:?} {piece:?} {region:?}");
        }
        for ((threshold, cell), value) in pieces.thresholds().iter().zip(&region).zip(switches) {
            let [lower, upper] = threshold.borders(*cell);
            prop_assert!(lower <= value && value <= upper);
        }
    }
}

#[test]
fn a_piece_goes_on_beyond_its_border() {
    let model = Model::parse("x'=if(x<1)then(2*x)else(5)\ndone\n").unwrap();
    let pieces = Pieces::of(&model).unwrap();
    assert_eq!(pieces.thresholds(), [Threshold::Zero]);
    let left = pieces.region_at(&[0.0], &[]);
    let (mut derivative, mut switches) = ([0.0], [0.0]);
    pieces.evaluate(&left, &[3.0], &[], &mut derivative, &mut switches);
    assert_eq!(derivative, [6.0]);
    assert_eq!(switches[0].abs(), 2.0);
    let border = Border { switch: 0, value: 0.0, upwards: left[0] < 0.0 };
    let right = pieces.beyond(&left, border, &[1.0], &[]);
    pieces.evaluate(&right, &[3.0], &[], &mut derivative, &mut switches);
    assert_eq!(derivative, [5.0]);
}

#[test]
fn what_depends_on_a_jump_jumps_with_it() {
    // Where x passes 1 the inner step jumps, and with it the outer one; the kink of |x - 1| does not jump.
    let model = Model::parse("x'=heav(2*heav(x-1)-1)+abs(x-1)\ndone\n").unwrap();
    let pieces = Pieces::of(&model).unwrap();
    let left = pieces.region_at(&[0.5], &[]);
    let border = Border { switch: 0, value: 0.0, upwards: true };
    assert_eq!(pieces.beyond(&left, border, &[1.0], &[]), pieces.region_at(&[1.5], &[]));
}

#[test]
fn what_switches_on_time_or_parameters_is_no_switch_on_the_state() {
    let model = Model::parse("par p=1\nx'=heav(t-p)*abs(p)-x\ndone\n").unwrap();
    assert!(model.thresholds().is_empty());
}
