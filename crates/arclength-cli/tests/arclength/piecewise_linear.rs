//! Cycles of oscillators that are linear piece by piece, against their solutions in closed form.
//!
//! Within a piece `x' = A x + b` the state after a time t is `exp(A t) x` plus the integral of `exp(A s) b`. The times in the pieces and
//! the state at a border were found by Newton's method with 40 digits (mpmath, exponentials of matrices by Arb), the multipliers as
//! eigenvalues of the product of the exponentials and the saltation matrices `R + (f+ - R f-) h' / (h' f-)` at the borders, extremes where
//! a component of the velocity vanishes or at a border, folds with one more unknown and the condition that a multiplier is one, grazings
//! with that of a velocity along the border that vanishes there. That no other border is passed on the way was checked.

use crate::found_by_users::{folder, number, points};
use crate::{Folder, labelled};
use serde_json::Value;

/// A folder with a model and the motion on which it has settled.
pub(crate) fn settled(model: &str, duration: f64) -> Folder {
    let folder = folder(model);
    folder.succeed(&format!("simulate model.ode --duration {duration} -o h.json -q"));
    folder
}

/// That cycles are those of a table: of each, up to a semicolon, the value of the parameter, the period, `largest:smallest` of every
/// state and the multipliers without the trivial one, a pair as `a±bi`.
#[track_caller]
pub(crate) fn check(cycles: &Value, states: &str, table: &str) {
    let names: Vec<&str> = states.split_whitespace().collect();
    for row in table.split(';').map(str::trim).filter(|row| !row.is_empty()) {
        let parts: Vec<&str> = row.split_whitespace().collect();
        let [value, period] = [0, 1].map(|index| parts[index].parse::<f64>().unwrap());
        let extremes: Vec<[f64; 2]> = parts[2..2 + names.len()].iter().map(|part| extremes(part)).collect();
        // Errors as parts of the period and of the amplitudes.
        let errors = |point: &Value| {
            let of_states = names.iter().zip(&extremes).flat_map(|(name, [max, min])| {
                [("max", max), ("min", min)]
                    .map(|(kind, truth)| (number(&point[kind][name]) - truth).abs() / (max - min))
            });
            of_states.fold((number(&point["period"]) / period - 1.0).abs(), f64::max)
        };
        // A branch may pass a value more than once.
        let candidates = points(cycles).iter().filter(|point| number(&point["value"]) == value);
        let point = candidates.min_by(|a, b| errors(a).total_cmp(&errors(b)));
        let point = point.unwrap_or_else(|| panic!("no cycle at {row}"));
        let allowed = (3.0 * number(&point["error_estimate"])).clamp(1e-9, 1e-8);
        assert!(errors(point) <= allowed, "{row}: {} {} {}", point["period"], point["max"], point["min"]);
        let multipliers = multipliers(&parts[2 + names.len()..]);
        check_multipliers(point, &multipliers, row);
        let stable = multipliers.iter().all(|[real, imaginary]| real.hypot(*imaginary) < 1.0);
        assert_eq!(point["stable"], stable, "{row}");
    }
}

fn extremes(part: &str) -> [f64; 2] {
    let (max, min) = part.split_once(':').unwrap();
    [max, min].map(|end| end.parse().unwrap())
}

fn multipliers(parts: &[&str]) -> Vec<[f64; 2]> {
    let of_part = |part: &&str| {
        let (real, imaginary) = part.trim_end_matches('i').split_once('±').unwrap_or((part, "0"));
        let [real, imaginary] = [real, imaginary].map(|number| number.parse::<f64>().unwrap());
        if imaginary == 0.0 { vec![[real, 0.0]] } else { vec![[real, imaginary], [real, -imaginary]] }
    };
    parts.iter().flat_map(of_part).collect()
}

/// Each within 1e-8, and within what is told of its error, which is relative.
#[track_caller]
fn check_multipliers(point: &Value, truth: &[[f64; 2]], row: &str) {
    let errors = point["multiplier_errors"].as_array().unwrap();
    let told = point["multipliers"].as_array().unwrap();
    assert_eq!(told.len(), truth.len() + 1, "{row}: {told:?}");
    for [real, imaginary] in truth {
        let distance = |other: &Value| (number(&other[0]) - real).hypot(number(&other[1]) - imaginary);
        let size = real.hypot(*imaginary);
        let nearest = (0..told.len()).min_by(|a, b| distance(&told[*a]).total_cmp(&distance(&told[*b])));
        let nearest = nearest.unwrap();
        let allowed = (3.0 * number(&errors[nearest]) * size).max(5e-12).min(1e-8 * size.max(1.0));
        assert!(distance(&told[nearest]) <= allowed, "{row}: {told:?}, errors {errors:?}");
    }
}

#[track_caller]
pub(crate) fn located(cycles: &Value, label: &str, truth: f64) {
    let value = number(&labelled(cycles, label)["value"]);
    assert!((value - truth).abs() < 1e-10 * truth.abs(), "{label} at {value}, not {truth}");
}

/// That an end of a branch tells of a grazing at a value, of which it has eight digits.
#[track_caller]
pub(crate) fn grazes(cycles: &Value, end: usize, truth: f64) {
    let cause = cycles["ends"][end]["cause"].as_str().unwrap();
    let (_, behind) = cause.split_once(" = ").unwrap_or_else(|| panic!("{cause}"));
    let value: f64 = behind.split(' ').next().unwrap().parse().unwrap();
    assert!(cause.starts_with("grazing: at ") && (value / truth - 1.0).abs() < 5e-8, "{cause}, not {truth}");
}

/// Two pieces are passed, those of the outer and of the inner slope of the resistor; the third one is not.
#[test]
fn the_circuit_of_chua() {
    let text = "par alpha=8,beta=14.285714285714286\nf(x)=-5/7*x-3/14*(abs(x+1)-abs(x-1))\n\
                x'=alpha*(y-x-f(x))\ny'=x-y+z\nz'=-beta*y\ninit x=1.6,y=0,z=-1.6\ndone\n";
    let folder = settled(text, 400.0);
    let cycles = folder.json("cycles --from h.json:END --along alpha=7:9 --at 7.2,7.5,7.8,8,8.1");
    check(
        &cycles,
        "x y z",
        "7.2 2.1195569336383 2.11567002727493:0.71950121355244 0.329847632940273:-0.335005778744982 0.150337223877746:-3.02692042731892 \
             0.34314007321476 0.0304400694578928; \
         7.5 2.16846813807373 2.13351675816592:0.586797881483335 0.338206613982059:-0.348137524211567 \
             0.280757762650003:-3.06409138492554 0.0121569968099955±0.109023544306514i; \
         7.8 2.21714729441997 2.13803404809454:0.473290557931604 0.338444379762565:-0.353445134635725 \
             0.37323975187239:-3.06607718272503 -0.0376934490977953 -0.342593425581007; \
         8 2.24999942882253 2.1367007431859:0.405711423565103 0.335812040115989:-0.354281499881348 0.420702913764776:-3.05575833111611 \
             -0.0195673404468832 -0.677312642613659; \
         8.1 2.26662121222177 2.13511945689948:0.374030133825976 0.333882427864773:-0.354102173488568 \
             0.441053416831225:-3.04812484237977 -0.015596742066078 -0.857022712068239;",
    );
    located(&cycles, "PD1", 8.17520835047838);
    // From the Hopf point of the outer piece, where cycles are neutral until they touch the border x = 1.
    folder.succeed("equilibria model.ode --start x=1.5,y=0,z=-1.5 --along alpha=5:9 -o e.json -q");
    let cycles = folder.json("cycles --from e.json:HB1 --along alpha=5:9 --at 8");
    check(
        &cycles,
        "x y z",
        "8 2.24999942882253 2.1367007431859:0.405711423565103 0.335812040115989:-0.354281499881348 0.420702913764776:-3.05575833111611 \
             -0.0195673404468832 -0.677312642613659;",
    );
    located(&cycles, "PD1", 8.17520835047838);
}

/// McKean's straight lines for the cubic of FitzHugh and Nagumo: three pieces, the middle one passed twice.
#[test]
fn the_nerve_of_mckean() {
    let text = "par i=.5,a=.25,eps=.1,g=.5\nf(v)=max(-v,min(v-a,1-v))\nv'=f(v)-w+i\nw'=eps*(v-g*w)\ndone\n";
    let folder = settled(text, 600.0);
    let cycles = folder.json("cycles --from h.json:END --along i=.4:.8 --at .42,.5,.6,.7,.78");
    check(
        &cycles,
        "v w",
        "0.42 40.84571050915 0.953006882185767:-0.286993535963085 0.846529721707209:0.289899493773066 9.78349073604036e-13; \
         0.5 35.1688649192246 0.972520072374885:-0.272454378677759 0.917487724174488:0.360832003368406 6.24204738256481e-11; \
         0.6 33.2807866893859 0.993666625947281:-0.253548150988334 1.00616605034816:0.449498869574349 2.4914227192826e-10; \
         0.7 33.8528659096739 1.0131221445694:-0.233378464338128 1.09483489383021:0.538171307381801 1.63778900957264e-10; \
         0.78 36.5168894910525 1.02795747955247:-0.215612381559123 1.1657677166743:0.609119328534164 2.32506019934073e-11;",
    );
}

/// A forced mass with a second spring behind a gap. The circle of the forcing has the multiplier `exp(-2 T)` across. At w = 1.8 the
/// gap stays open, with the amplitude `1/sqrt((1-w^2)^2 + 4 z^2 w^2)`, and it closes where that is g.
#[test]
fn a_bilinear_oscillator() {
    let text = "par w=1.5,z=.05,k=3,g=.5\nx'=v\nv'=-x-2*z*v-k*max(x-g,0)+c\nc'=c*(1-c^2-q^2)-w*q\n\
                q'=q*(1-c^2-q^2)+w*c\ninit c=1\ndone\n";
    let folder = settled(text, 300.0);
    let cycles =
        folder.json("cycles --from h.json:END --along w=.3:3 --at .9,1,1.2,1.5,1.8 --monitor max(x)=.5");
    check(
        &cycles,
        "x v c q",
        "0.9 6.98131700797732 1.32865001803059:-1.52080858737799 1.50500733145602:-1.43654516826262 1:-1 1:-1 \
             -0.572084350567282±0.412593549113711i 8.63187403455614e-7; \
         1 6.28318530717959 1.52936372153887:-2.0189062592159 1.922891156405:-1.85474912584136 1:-1 1:-1 \
             -0.118851093095329±0.720668098892374i 3.487342356209e-6; \
         1.2 5.23598775598299 2.85561030538953:-4.78484032615435 4.66147289623774:-4.55596511965069 1:-1 1:-1 \
             0.649216530806283±0.413403850146855i 2.83190591451621e-5; \
         1.5 4.18879020478639 0.971787334435302:-1.36718207159318 1.70242077109392:-1.69072079618838 1:-1 1:-1 \
             0.443688149479145±0.678914276497127i 0.0002299656956362; \
         1.8 3.49065850398866 0.444994159489985:-0.444994159489985 0.800989487081973:-0.800989487081973 1:-1 1:-1 \
             -0.790446699859273±0.283796927506112i 0.000929078792921039;",
    );
    located(&cycles, "LPC1", 0.314967081189638);
    located(&cycles, "LPC2", 0.313188875379561);
    located(&cycles, "LPC3", 0.612234340893246);
    located(&cycles, "LPC4", 0.610322884879365);
    let touches =
        points(&cycles).iter().find(|point| (number(&point["max"]["x"]) - 0.5).abs() < 1e-8).unwrap();
    assert!((number(&touches["value"]) - 1.72988574575351).abs() < 1e-8, "{}", touches["value"]);
}

/// Damped inside |x| < 1 for p > 0, excited up to 2, damped beyond: small cycles are unstable, large ones stable, from a fold on.
#[test]
fn saturations_make_a_fold_of_cycles() {
    let text = "par p=.1,b=.5,c=.5\nsat(x)=(abs(x+1)-abs(x-1))/2\nx'=y-c*x-(p+b)*sat(x)+2*(b+c)*sat(x/2)\n\
                y'=-x\ninit x=.9,y=3\ndone\n";
    let folder = settled(text, 400.0);
    let cycles = folder.json("cycles --from h.json:END --along p=-1:1 --at -.2,.1,.2,.3 --monitor max(x)=2");
    let table = "-0.2 6.32889009002922 4.13714350844234:-4.13714350844234 4.17067781709451:-4.17067781709451 0.238180915455505; \
         0.1 6.30359462623038 3.24900088798043:-3.24900088798043 3.26478179077042:-3.26478179077042 0.286169165250812; \
         0.2 6.29810110506508 2.91265479926113:-2.91265479926113 2.92307081901742:-2.92307081901742 0.331774370479295; \
         0.3 6.30255722231571 2.49548491290674:-2.49548491290674 2.50311902870852:-2.50311902870852 0.475146832716536; \
         0.3 6.32833989155674 1.94640647427995:-1.94640647427995 1.96178244213549:-1.96178244213549 4.18830970359584; \
         0.2 6.31364564977874 1.6709228795146:-1.6709228795146 1.68113453591925:-1.68113453591925 3.88793147242061; \
         0.1 6.2971585075726 1.38170075976318:-1.38170075976318 1.38657771676359:-1.38657771676359 3.34145729607788;";
    check(&cycles, "x y", table);
    located(&cycles, "LPC1", 0.337532403135401);
    // The middle pieces end where the outer ones begin.
    let touches =
        points(&cycles).iter().find(|point| (number(&point["max"]["x"]) - 2.0).abs() < 1e-8).unwrap();
    assert!((number(&touches["value"]) - 0.319759332499742).abs() < 1e-8, "{}", touches["value"]);
    // From the Hopf point, where cycles are neutral up to |x| = 1 and the branch turns a corner.
    folder.succeed("equilibria model.ode --start x=0,y=0 --along p=-1:1 -o e.json -q");
    let cycles = folder.json("cycles --from e.json:HB1 --along p=-1:1 --at -.2,.1,.2,.3");
    check(&cycles, "x y", table);
    located(&cycles, "LPC1", 0.337532403135401);
}

/// A block on a belt with Coulomb friction, which its negative damping excites, with a damper behind a second spring: it slips back
/// and sticks. All lengths grow as the speed of the belt.
#[test]
fn a_block_on_a_belt_with_a_damper() {
    let text =
        "par vb=.5,c=.2,F=1,k=.5,tau=2\nx'=y\ny'=-x+c*y-k*z-F*sign(y-vb)\nz'=y-z/tau\ninit x=.3\ndone\n";
    let folder = settled(text, 300.0);
    let cycles = folder.json("cycles --from h.json:END --along vb=.15:2.5 --at .2,.3,.5,1,2");
    check(
        &cycles,
        "x y z",
        "0.2 5.29962693524816 1.17101663228653:0.814017351737468 0.2:-0.212829229364592 0.161742570167973:-0.166064637250539 \
             0.124752342616275 0; \
         0.3 5.29962693524816 1.25652494842979:0.721026027606203 0.3:-0.319243844046888 0.242613855251959:-0.249096955875808 \
             0.124752342616275 0; \
         0.5 5.29962693524816 1.42754158071631:0.535043379343671 0.5:-0.532073073411481 0.404356425419931:-0.415161593126347 \
             0.124752342616275 0; \
         1 5.29962693524816 1.85508316143263:0.0700867586873421 1:-1.06414614682296 0.808712850839863:-0.830323186252694 \
             0.124752342616275 0; \
         2 5.29962693524816 2.71016632286526:-0.859826482625316 2:-2.12829229364592 1.61742570167973:-1.66064637250539 \
             0.124752342616275 0;",
    );
}

/// A relay with a linear system of order three: the cycle slides twice in a period. At the smaller end the slide touches the place
/// where it would be left (x = 0, y = -1).
#[test]
fn a_relay_that_slides() {
    let text = "par sigma=-.07,zeta=.05,lambda=1,w=10\nx'=y-(2*zeta*w+lambda)*x-sign(x)\n\
                y'=z-(2*zeta*w*lambda+w^2)*x-2*sigma*sign(x)\nz'=-lambda*w^2*x-sign(x)\ninit x=.1,y=.3,z=.2\ndone\n";
    let folder = settled(text, 200.0);
    let cycles = folder.json("cycles --from h.json:END --along sigma=-.6:-.01 --at -.25,-.2,-.15,-.1,-.05");
    check(
        &cycles,
        "x y z",
        "-0.25 5.88443715094546 0.0217381456597373:-0.0217381456597373 1.14265976016069:-1.14265976016069 \
             1.33618818478196:-1.33618818478196 0.0666022183810913 0; \
         -0.2 5.83560586008572 0.017553400528067:-0.017553400528067 1.11601204060556:-1.11601204060556 \
             1.22471031812591:-1.22471031812591 0.0126793025978714 0; \
         -0.15 5.84597994885541 0.0136905823178862:-0.0136905823178862 1.09138822457065:-1.09138822457065 \
             1.14206992060222:-1.14206992060222 7.26651869913816e-5 0; \
         -0.1 5.91054651790848 0.00985421987772718:-0.00985421987772718 1.06688355190683:-1.06688355190683 \
             1.07795567214347:-1.07795567214347 0.0172690683967625 0; \
         -0.05 6.04039990467354 0.00573075353644527:-0.00573075353644527 1.04040522486959:-1.04040522486959 \
             1.02986619061752:-1.02986619061752 0.0927316422929024 0;",
    );
    let last = number(&cycles["ends"][0]["last"]["sigma"]);
    assert!((last + 0.292398255970023).abs() < 1e-8, "{last}");
}
