//! The page for towed wheels: what [`arclength_page`] serves for `kingpin serve`.
//!
//! Requests and results are those of [`kingpin_analysis`]. A wheel is all of its parameters by key; no request may name a file.

mod analyses;
mod limits;
mod wheels;

use arclength_page::{Asset, Site, joined, model_site};
use kingpin::Wheel;

/// The files of the page that are its own.
const ASSETS: &[Asset] = &[
    Asset { path: "/", text: include_str!("../assets/wheel.html") },
    Asset { path: "/wheel.css", text: include_str!("../assets/wheel.css") },
    Asset { path: "/wheel.js", text: include_str!("../assets/wheel.js") },
    Asset { path: "/branches.js", text: include_str!("../assets/branches.js") },
    Asset { path: "/above.js", text: include_str!("../assets/above.js") },
    Asset { path: "/plane.js", text: include_str!("../assets/plane.js") },
    Asset { path: "/motions.js", text: include_str!("../assets/motions.js") },
    Asset { path: "/lines.js", text: include_str!("../assets/lines.js") },
    Asset { path: "/picture.js", text: include_str!("../assets/picture.js") },
];

/// The page for wheels, which begins with this one. The page for any model stands beside it.
pub fn wheel_site(wheel: &Wheel) -> Site {
    let models = model_site(None);
    let moved = |asset: Asset| if asset.path == "/" { Asset { path: "/model.html", ..asset } } else { asset };
    Site {
        assets: ASSETS.iter().copied().chain(models.assets.into_iter().map(moved)).collect(),
        routes: models.routes.merge(wheels::routes()).merge(analyses::routes()),
        description: joined(models.description, include_str!("../openapi.json")),
        start: serde_json::json!({ "wheel": wheels::WheelAnswer::of(wheel), "version": env!("CARGO_PKG_VERSION") }),
    }
}
