//! No text makes the reader panic or hang, and every place it names is in the text.

use arclength::VectorField;
use arclength_ode::Model;
use proptest::prelude::*;

const MODELS: [&str; 4] = [
    include_str!("../../../../gallery/models/morris_lecar.ode"),
    include_str!("../../../../gallery/models/towed_wheel.ode"),
    include_str!("../../../../gallery/models/lorenz.ode"),
    "par k[1..3]=[j]\n%[1..3]\nx[j]'=sum(0,2)of(shift(x1,i')*k[j])\\\n-x[j]\ninit x[j]=1\n%\nf(a,b)=if(a>b)then(a)else(b)\n\
     y'=f(y,t)+besselj(1,y)\n!c=k1^2\nset s {y=1,k1=3}\naux q=mod(y,c)\n@ total=10\ndone\n",
];

fn read(bytes: &[u8]) {
    match Model::parse_bytes(bytes) {
        Ok(model) => {
            let parameters = model.default_parameters();
            let mut derivative = vec![0.0; model.dimension()];
            model.evaluate(&model.initial_state(parameters), parameters, &mut derivative);
            assert!(Model::parse(model.source()).is_ok());
            for warning in model.warnings() {
                assert!(!warning.place.snippet().is_empty());
            }
        }
        Err(error) => {
            assert!(!error.snippet().is_empty());
            if let Some(place) = error.place() {
                let length = place.source_line.chars().count();
                assert!(place.line >= 1 && place.column >= 1 && place.column <= length + 1, "{error}");
            }
        }
    }
}

/// Pieces of the language, so that random texts get past the first character.
fn piece() -> impl Strategy<Value = String> {
    let words = [
        "x",
        "y",
        "a",
        "'",
        "=",
        "x'=",
        "par ",
        "init ",
        "aux ",
        "number ",
        "set s {",
        "}",
        "@ ",
        "total=",
        "(",
        ")",
        "+",
        "-",
        "*",
        "/",
        "^",
        ">",
        "&",
        ",",
        " ",
        "\n",
        "\r\n",
        "\\\n",
        "[1..3]",
        "[j]",
        "[j+1]",
        "[",
        "]",
        "%",
        "sum(",
        "of(",
        "i'",
        "shift(x,",
        "if(",
        "then(",
        "else(",
        "1",
        "0",
        "2.5e3",
        "1e999",
        "t",
        "pi",
        "f(x)=",
        "!c=",
        "sin(",
        "exp(",
        "ln(",
        "besselj(",
        "mod(",
        "x(0)=",
        "dx/dt=",
        "done",
        "#",
        "\"",
        "global ",
        "global 1 x {x=y}",
        "t+1",
    ];
    prop::sample::select(words.to_vec()).prop_map(str::to_owned)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn random_bytes(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        read(&bytes);
    }

    #[test]
    fn random_pieces(pieces in prop::collection::vec(piece(), 0..80)) {
        read(pieces.concat().as_bytes());
        read(format!("x'=1\npar a=1\n{}", pieces.concat()).as_bytes());
    }

    #[test]
    fn mutated_models(which in 0..MODELS.len(), edits in prop::collection::vec((any::<prop::sample::Index>(), 0..4_u8, piece()), 1..6)) {
        let mut text: Vec<char> = MODELS[which].chars().collect();
        for (at, kind, piece) in edits {
            let at = at.index(text.len().max(1)).min(text.len().saturating_sub(1));
            match kind {
                0 => { text.splice(at..at, piece.chars()); }
                1 if !text.is_empty() => { text.remove(at); }
                2 => text.truncate(at),
                _ => { let end = text.len().min(at + 5); text.splice(at..end, piece.chars()); }
            }
        }
        read(text.iter().collect::<String>().as_bytes());
    }
}

#[test]
fn extreme_numbers_are_read_without_panic() {
    for source in [
        "x'=besselj(1e300,x)\n",
        "x'=x^1e300\n",
        "x'=x^-2147483648\n",
        "x'=x^2147483647\n",
        "x'=1e999*x\n",
        "x'=mod(x,0)\n",
        "x'=sum(1e300,1e300)of(i')\n",
        "x'=sum(-1e999,0)of(x)\n",
        "x'=shift(x,1e300)\n",
        "x'=shift(x,0/0)\n",
        "x[-3..-1]'=1\n",
        "x[1..1]'=[j*2147483647]\n",
        "x'=bessely(0,0*x)\n",
    ] {
        read(source.as_bytes());
    }
}
