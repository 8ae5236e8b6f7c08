//! Random scenes: bodies, supports, drives, loads and models drawn by lot, the same ones each time.

use super::cases::{CheckedCase, SOFT, Truth};
use crate::lot::Lot;

/// A body, and the point at its end.
const BODIES: [(&str, [f64; 3]); 4] = [
    ("column", [1.0, 0.0, 0.0]),
    ("coned", [1.0, 0.0, 0.05]),
    ("blade", [1.0, 0.267_949_192_431_122_7, 0.0]),
    ("arc", [1.0, 0.0, 1.0]),
];

/// `count` scenes, each with the number of its model.
pub fn random_cases(count: usize) -> Vec<(CheckedCase, usize)> {
    let mut lot = Lot::new();
    (0..count).map(|_| random_case(&mut lot)).collect()
}

fn random_case(lot: &mut Lot) -> (CheckedCase, usize) {
    let (mesh, tip) = BODIES[lot.of(BODIES.len())];
    let constant = "history = { kind = \"constant\" }\n";
    let (support, spins, truth) = match lot.of(10) {
        0..4 => ("clamp", false, Truth::Rest),
        4..7 => ("spin", true, Truth::Rest),
        7..9 => ("spin-up", true, Truth::OfRow),
        _ => ("slider", false, Truth::OfRow),
    };
    let hinge = "[[constraints]]\nkind = \"hinge\"\nat = [0.0, 0.0, 0.0]\naxis = [0.0, 0.0, 1.0]\ngroup = \"root\"\n\
                 [constraints.motion]\namplitude = SPIN\n";
    let mut text = match support {
        "clamp" => "[[constraints]]\nkind = \"clamp\"\ngroup = \"root\"\n".to_owned(),
        "spin" => format!("{hinge}{constant}"),
        // It speeds up by a part of the spin in a unit of time.
        "spin-up" => format!("{hinge}history = {{ kind = \"expression\", formula = \"1 + {:.6}*t\" }}\n", lot.number()),
        _ => format!(
            "[[constraints]]\nkind = \"slider\"\ndirection = {:?}\ngroup = \"root\"\n[constraints.motion]\namplitude = GRAVITY\n\
             history = {{ kind = \"expression\", formula = \"t\" }}\n",
            lot.direction()
        ),
    };
    let spin = if spins { lot.between(0.05, 1.5) } else { 0.0 };
    let (mut force, mut gravity) = (0.0, if support == "slider" { lot.between(0.01, 0.4) } else { 0.0 });
    let load =
        if spins && lot.number() < 0.5 { "no load" } else { ["force", "gravity", "moment", "pressure"][lot.of(4)] };
    let direction = lot.direction();
    match load {
        "force" => {
            force = lot.between(0.003, 0.5);
            text += &format!(
                "[[loads]]\nkind = \"force\"\nat = {tip:?}\ndirection = {direction:?}\namplitude = FORCE\n{constant}"
            );
        }
        "gravity" if support != "slider" => {
            gravity = lot.between(0.005, 0.4);
            text +=
                &format!("[[loads]]\nkind = \"gravity\"\ndirection = {direction:?}\namplitude = GRAVITY\n{constant}");
        }
        "moment" => {
            force = lot.between(0.003, 0.3);
            text += &format!(
                "[[loads]]\nkind = \"moment\"\nat = {tip:?}\nradius = 0.06\ndirection = {direction:?}\namplitude = FORCE\n{constant}"
            );
        }
        "pressure" => {
            // On the tip, of about a thousandth of a square metre.
            force = 1e3 * lot.between(0.003, 0.3);
            text += &format!("[[loads]]\nkind = \"pressure\"\ngroup = \"tip\"\namplitude = FORCE\n{constant}");
        }
        _ => {}
    }
    let name = format!("{mesh}, {support}, {load}");
    (
        CheckedCase {
            name,
            mesh,
            material: SOFT,
            text,
            parameter: 1.0,
            parts: [spin, force, gravity],
            tip,
            spins: false,
            truth,
        },
        lot.of(3),
    )
}
