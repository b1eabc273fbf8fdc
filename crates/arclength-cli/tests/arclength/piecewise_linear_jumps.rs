//! Oscillators that are linear piece by piece and jump at events or are switched by a clock; see `piecewise_linear`.

use crate::found_by_users::{number, points};
use crate::piecewise_linear::{check, grazes, located, settled};

/// A forced mass that hits a stop. Beyond the second end lies the motion without impacts, which touches the stop where its amplitude
/// `1/sqrt((1-w^2)^2 + 4 z^2 w^2)` is s; at the first end a second impact comes between.
#[test]
fn an_impact_oscillator() {
    let text = "par w=1.5,z=.1,s=.5,r=.7\nx'=v\nv'=-x-2*z*v+c\nc'=c*(1-c^2-q^2)-w*q\nq'=q*(1-c^2-q^2)+w*c\n\
                global 1 x-s {v=-r*v}\ninit c=1\ndone\n";
    let folder = settled(text, 400.0);
    let cycles = folder.json("cycles --from h.json:END --along w=.3:5 --at 1,1.2,1.5,1.8");
    check(
        &cycles,
        "x v c q",
        "1 6.28318530717959 0.5:-1.14187899472837 1.69204957600053:-1.18443470320037 1:-1 1:-1 -0.322387313096582 -0.432581154931723 \
             3.487342356209e-6; \
         1.2 5.23598775598299 0.5:-1.15542968377335 1.71475628110961:-1.20032939677672 1:-1 1:-1 -0.318527377549864±0.265501441179945i \
             2.83190591451621e-5; \
         1.5 4.18879020478639 0.5:-1.66968613553519 2.16444707351812:-1.51266048433394 1:-1 1:-1 0.174887568220987±0.425942821136759i \
             0.0002299656956362; \
         1.8 3.49065850398866 0.5:-2.18229673604148 2.48311578614905:-1.81039359453307 1:-1 1:-1 0.333928745442633 0.730041466584842 \
             0.000929078792921039; \
         1.8 3.49065850398866 0.5:-0.850770564984138 1.13321875891959:-1.08544930929041 1:-1 1:-1 0.123939942257093 1.96693516729329 \
             0.000929078792921039;",
    );
    located(&cycles, "LPC1", 1.83510692380723);
    grazes(&cycles, 0, 0.794225121827037);
    grazes(&cycles, 1, 1.72339066246075);
}

/// The system 1/(s+1)^3 with a relay with hysteresis and a load: at no load the cycle of Tsypkin.
#[test]
fn a_relay_with_hysteresis() {
    let text = "par d=2,K=10,h=.5\nx'=y-x\ny'=z-y\nz'=d-K*m-z\nm'=0\nglobal 1 x-h {m=1}\nglobal -1 x+h {m=-1}\n\
                init x=1,m=1\ndone\n";
    let folder = settled(text, 200.0);
    let cycles = folder.json("cycles --from h.json:END --along d=-9:9 --at -3,0,2,4,6");
    check(
        &cycles,
        "x y z m",
        "-3 4.44191178332528 1.68177295409197:-2.93291056854551 3.49780971719811:-4.97514489441736 5.92253705949551:-9.57322053431773 \
             1:-1 0.0464601448136206 3.51257908492116e-5 0; \
         0 4.3241107918703 2.32163494945063:-2.32163494945063 4.3486061193494:-4.3486061193494 7.93579893109807:-7.93579893109807 1:-1 \
             0.052104825350691 4.4597415092051e-5 0; \
         2 4.37471498771533 2.73496291651996:-1.89569098202821 4.79123466422114:-3.80731029723809 9.07641280780723:-6.62982866930603 \
             1:-1 0.049609894290384 4.02427787689782e-5 0; \
         4 4.54441282820567 3.1225660203985:-1.46940316008933 5.13267323437696:-3.1600093849333 10.0120155008552:-5.1816030090815 1:-1 \
             0.0419983363710336 2.85711465028583e-5 0; \
         6 4.91143973533182 3.46739123873449:-1.05780185906584 5.35956750371094:-2.38584507309048 10.6741383557062:-3.60238705572944 \
             1:-1 0.029035509309464 1.37415912426906e-5 0;",
    );
}

/// A leaky neuron that adapts: v' = i - v - w until v = 1, where it is reset and w grows. Firing ends in a fold, just behind which the
/// threshold is met without speed.
#[test]
fn a_neuron_that_adapts() {
    let text = "par i=1.5,a=.5,tau=3,b=.3\nv'=i-v-w\nw'=(a*v-w)/tau\nglobal 1 v-1 {v=0;w=w+b}\ndone\n";
    let folder = settled(text, 200.0);
    let cycles = folder.json("cycles --from h.json:END --along i=.9:6 --at 1.5,2,3,4,5");
    check(
        &cycles,
        "v w",
        "1.5 5.99086153375696 1:0 0.795601279727947:0.49446194654519 0.0543786062548251; \
         2 1.72491998942184 1:0 1.00861319970477:0.708613199704773 0.341147568493727; \
         3 0.874029702550741 1:0 1.47439332194677:1.17439332194677 0.576174917281506; \
         4 0.59409982049385 1:0 1.94535302004745:1.64535302004745 0.686897679699344; \
         5 0.451246439673063 1:0 2.41763215534583:2.11763215534583 0.751649128421854;",
    );
    located(&cycles, "LPC1", 1.49655962556747);
    grazes(&cycles, 0, 1.49656035057324);
}

/// The buck converter of Deane and Hamill, in milliseconds: a comparator of the voltage with a sawtooth, whose clock is a state.
/// Published: the period doubles at about 24.5 V.
#[test]
fn a_buck_converter() {
    let text = "par E=22\nv'=(i-v/22)/.047\ni'=((if((8.4*(v-11.3))<(3.8+4.4*s/.4))then(E)else(0))-v)/20\ns'=1\n\
                global 1 s-.4 {s=0}\ninit v=11,i=.5\ndone\n";
    let folder = settled(text, 100.0);
    let cycles = folder.json("cycles --from h.json:END --along E=14:40 --at 15,20,22,24,30");
    check(
        &cycles,
        "v i s",
        "15 0.4 11.8749576174052:11.8218005141765 0.563309393603349:0.513343889689745 0.4:0 -0.613089476917135±0.550741467859838i; \
         20 0.4 12.0076236050842:11.9050095722499 0.591571935915189:0.49505788287193 0.4:0 -0.691894155835222±0.447746968999235i; \
         22 0.4 12.0474889480764:11.9310784292392 0.599635798352368:0.490138396018012 0.4:0 -0.752798368738601±0.335394524629484i; \
         24 0.4 12.0819477973999:11.9539214568302 0.606481024768377:0.486055549878689 0.4:0 -0.821086496538983±0.0707943241247098i; \
         30 0.4 12.1618064796045:12.0078053676231 0.621962270332911:0.477115733460819 0.4:0 -0.399273564997575 -1.70107648156236;",
    );
    located(&cycles, "PD1", 24.5165728285634);
}

/// A linear system of order three with a relay, whose cycle shrinks to its equilibrium at a = 1 while the period tends to zero. The periods
/// are twice the times after which the piece of one sign takes a point of the border to its opposite (SciPy, matrix exponentials).
#[test]
fn a_relay_whose_cycle_shrinks_to_a_point() {
    let text = "par k=1,a=.3\nx'=y\ny'=z\nz'=-z-2*y-x/2-k*sign(x+a*y)\ninit x=1\ndone\n";
    let folder = settled(text, 100.0);
    let cycles = folder.json("cycles --from h.json:END --along a=.1:2 --at .2,.5,.8");
    for (value, period) in [(0.2, 4.0858403462674975), (0.5, 3.367965105963388), (0.8, 2.231624823289572)] {
        let point = points(&cycles).iter().find(|point| point["value"] == value).unwrap();
        assert!((number(&point["period"]) - period).abs() < 1e-8, "{value}: {}", point["period"]);
        assert_eq!(point["stable"], true);
    }
    let end = &cycles["ends"][1];
    assert!(end["cause"].as_str().unwrap().starts_with("the period tends to zero"), "{end}");
    assert!((number(&end["last"]["a"]) - 1.0).abs() < 1e-6, "{end}");
    assert!(cycles.get("unlocated").is_none_or(|changes| changes.as_array().unwrap().is_empty()));
}

/// Den Hartog's oscillator with dry friction: from some force of friction on the mass sticks where it turns, which a long step of the branch
/// leads over. Truth: exact arcs and sticking until the force is larger than friction (DOP853 with events, tolerance 1e-13).
#[test]
fn sticking_begins_along_a_branch_however_long_its_steps_are() {
    for (damping, largest) in [
        ("0.2", &[(0.7, 0.9734927266), (0.75, 0.760487782108), (0.8, 0.470984333299)][..]),
        ("0", &[(0.79, 1.376578406581), (0.8, 1.342865207489)]),
    ] {
        let model = format!(
            "par F=0.1,w=0.75,c={damping}\nx'=y\ny'=-x-c*y-F*sign(y)+u\nu'=u*(1-u^2-v^2)-w*v\nv'=v*(1-u^2-v^2)+w*u\n\
             init u=1\ndone\n"
        );
        let folder = settled(&model, 500.37);
        let values: Vec<String> = largest.iter().map(|(force, _)| format!("{force}")).collect();
        for finer in ["", " --finer 10"] {
            let at = values.join(",");
            let cycles =
                folder.json(&format!("cycles --from h.json:END --along F=0.05:0.8 --at {at}{finer}"));
            for (force, largest) in largest {
                let point = points(&cycles).iter().find(|point| number(&point["value"]) == *force).unwrap();
                let [error, told] = [number(&point["max"]["x"]) - largest, number(&point["error_estimate"])];
                assert!(error.abs() < 1e-9 && told < 1e-8, "{damping} {force}: {error:e}, told {told:e}");
                assert_eq!(point["stable"], true, "{damping} {force}");
            }
        }
    }
}
