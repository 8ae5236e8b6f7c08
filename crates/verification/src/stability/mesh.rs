//! Mesh and material: slivers, curved elements, extreme materials and units, one element, any numbering, symmetry, and
//! meshes that are no body.

use dynamics::Method;
use fem_tet10::{Material, Materials, Mesh, MeshParts, PointMass, assemble};

use crate::stability::Bound::{Refused, Within};
use crate::stability::bodies::ElasticBody;
use crate::stability::case::on;
use crate::stability::meshes::{EDGES, ball, box_mesh, cells_of, cracked, numbered, opened};
use crate::stability::structure::tumble;
use crate::stability::{BodyFigure, Bound, Extent, HardCase, TrialOutcome};

const DRIFT: &str = "drift";
/// Bounds of the tumbling of any well-made body.
const TUMBLING: [Bound; 4] = [Within(1e-8), Within(1e-5), Within(0.1), Within(0.1)];

/// The cases.
pub fn cases() -> Vec<HardCase> {
    vec![
        HardCase {
            name: "a layer of slivers of aspect 1e4 in a cube",
            why: "stiffnesses across and along an element differ by 1e8",
            body: Some(BodyFigure {
                what: "difference of the frequencies without the layer, relative",
                figure: || difference(&with_layer()?, &bar([1.0; 3], [2; 3], METRES, 8)?),
                expected: Within(0.02),
            }),
            measure: DRIFT,
            run: |method, _| moves(with_layer(), method),
            expected: TUMBLING,
        },
        HardCase {
            name: "a ribbon of slivers, 20 000 times as long as thick",
            why: "stiffnesses along and across differ by the square of that: rounding in K is as large as the bending stiffness (it puts the lowest frequency off by up to 6 % at 10 000 times, and from 13 000 times on by any factor)",
            body: None,
            measure: "–",
            run: |method, _| moves(bar([10.0, 0.1, 5e-4], [10, 1, 1], METRES, 6), method),
            expected: [Refused("rounding hides"); 4],
        },
        HardCase {
            name: "a ribbon of slivers, 100 000 times as long as thick",
            why: "its bending stiffness is a thousandth of the rounding in that of its elements, and may come out negative",
            body: None,
            measure: "–",
            run: |method, _| moves(bar([10.0, 0.1, 1e-4], [10, 1, 1], METRES, 6), method),
            expected: [Refused("too thin"); 4],
        },
        HardCase {
            name: "a plate of 1000×50×0.1",
            why: "10 000 times as long as thick",
            body: Some(BodyFigure {
                what: "lowest frequency against a thin beam, relative (a wide strip is 1/√(1 − ν²) = 1.048 of it)",
                figure: || against_beam([1000.0, 50.0, 0.1], [40, 2, 1]),
                expected: Within(0.1),
            }),
            measure: DRIFT,
            run: |method, _| moves(bar([1000.0, 50.0, 0.1], [40, 2, 1], METRES, 6), method),
            expected: TUMBLING,
        },
        HardCase {
            name: "curved elements: a bar bent to a quarter of a ring",
            why: "the mid-edge nodes leave the edges, and the integrands are no polynomials",
            body: Some(BodyFigure {
                what: "mass against the ring's, relative",
                figure: || Ok((quarter_ring()?.body.mass / QUARTER - 1.0).abs()),
                expected: Within(1e-3),
            }),
            measure: DRIFT,
            run: |method, _| moves(quarter_ring(), method),
            expected: TUMBLING,
        },
        HardCase {
            name: "ν = 0.4999",
            why: "the volume can hardly change: an element that locks is too stiff",
            body: Some(BodyFigure {
                what: "lowest frequency against ν = 0.49 of the same shear modulus, relative",
                figure: || {
                    let lowest = |nu: f64| {
                        let material = Material { young_modulus: 2.0 * (1.0 + nu), poisson_ratio: nu, density: 1.0 };
                        Ok::<f64, String>(bar([1.0; 3], [3; 3], material, 1)?.body.circular_frequencies[0])
                    };
                    Ok((lowest(0.4999)? / lowest(0.49)? - 1.0).abs())
                },
                expected: Within(0.05),
            }),
            measure: DRIFT,
            run: |method, _| moves(bar([1.0; 3], [2; 3], Material { poisson_ratio: 0.4999, ..METRES }, 10), method),
            expected: TUMBLING,
        },
        HardCase {
            name: "ν = −0.9",
            why: "the bulk modulus is a forty-second of the shear modulus: the body would rather change its size than its shape",
            body: None,
            measure: DRIFT,
            run: |method, _| moves(bar([1.0; 3], [2; 3], Material { poisson_ratio: -0.9, ..METRES }, 10), method),
            expected: TUMBLING,
        },
        HardCase {
            name: "a square plate",
            why: "frequencies that repeat in the plate do so only nearly in its mesh",
            body: Some(BodyFigure {
                what: "relative gap within the 4th and 5th and the 6th and 7th frequency, equal in a plate",
                figure: || gap(&bar([1.0, 1.0, 0.05], [6, 6, 1], METRES, 8)?, &[3..5, 5..7]),
                expected: Within(5e-2),
            }),
            measure: DRIFT,
            run: |method, _| moves(bar([1.0, 1.0, 0.05], [6, 6, 1], METRES, 8), method),
            expected: TUMBLING,
        },
        HardCase {
            name: "a bar in metres and in micrometres",
            why: "lengths differ by 1e6, the entries of K by 1, those of M by 1, inertias by 1e12",
            body: Some(BodyFigure {
                what: "difference of the frequencies, relative",
                figure: || difference(&bar(STEEL_BAR, [8, 2, 2], STEEL, 8)?, &micrometres()?),
                expected: Within(1e-8),
            }),
            measure: DRIFT,
            run: |method, _| moves(micrometres(), method),
            expected: TUMBLING,
        },
        HardCase {
            name: "one element with all of its 24 modes",
            why: "the smallest mesh; nothing is left to truncate",
            body: None,
            measure: DRIFT,
            run: |method, _| moves(one_element(), method),
            expected: TUMBLING,
        },
        HardCase {
            name: "nodes and elements numbered at random",
            why: "bandwidth, pivots and the order of every sum change",
            body: Some(BodyFigure {
                what: "difference of the frequencies, relative",
                figure: || difference(&bar(STEEL_BAR, [8, 2, 2], STEEL, 8)?, &shuffled()?),
                expected: Within(1e-8),
            }),
            measure: DRIFT,
            run: |method, _| moves(shuffled(), method),
            expected: TUMBLING,
        },
        HardCase {
            name: "a cube of elements",
            why: "its frequencies repeat, but its mesh has not all of its symmetry",
            body: Some(BodyFigure {
                what: "relative gap within the groups of 2, 3, 3 and 2 lowest frequencies, equal in a cube",
                figure: || gap(&bar([1.0; 3], [3; 3], METRES, 10)?, &[0..2, 2..5, 5..8, 8..10]),
                expected: Within(2e-2),
            }),
            measure: DRIFT,
            run: |method, _| moves(bar([1.0; 3], [3; 3], METRES, 10), method),
            expected: TUMBLING,
        },
        HardCase {
            name: "a ball of curved elements",
            why: "the inertia of a sphere; frequencies that repeat five times in a ball do so only nearly in its mesh",
            body: Some(BodyFigure {
                what: "the five lowest frequencies against Lamb's k a = 2.50113 of torsion, relative",
                figure: || {
                    let lamb = 2.501_132_620_409_396 * shear_speed(METRES);
                    let found = solve(ball(2), METRES, 10)?.body.circular_frequencies.clone();
                    Ok(found[..5].iter().map(|omega| (omega / lamb - 1.0).abs()).fold(0.0, f64::max))
                },
                expected: Within(5e-3),
            }),
            measure: DRIFT,
            run: |method, _| moves(solve(ball(1), METRES, 10), method),
            expected: TUMBLING,
        },
        HardCase {
            name: "a point mass of 1e6 times the rest of a mesh",
            why: "M spans twelve orders of magnitude, and the body swings about a point that hardly moves",
            body: Some(BodyFigure {
                what: "difference of the frequencies from those with a mass of 1e9 times the rest, relative, the largest of six places",
                figure: || {
                    let of_place = |place: &[f64; 3]| difference(&loaded(*place, 1e6, 6)?, &loaded(*place, 1e9, 6)?);
                    PLACES.iter().try_fold(0.0, |largest, place| Ok(f64::max(largest, of_place(place)?)))
                },
                expected: Within(1e-5),
            }),
            measure: DRIFT,
            run: |method, _| moves(loaded(PLACES[0], 1e6, 6), method),
            expected: TUMBLING,
        },
        refused(
            "a spread point mass of 1e12 times the rest of a mesh",
            "what the masses of its nodes add up to in a motion in which it rests is rounding",
            "rounding hides the mass",
            |method, _| moves(loaded(PLACES[1], 1e12, 6), method),
        ),
        refused(
            "all modes of a mesh with a spread point mass of 1e9 times the rest",
            "rounding in M is as large as what the highest modes add to the rest",
            "do masses or stiffnesses within the body differ by many powers of ten",
            |method, _| moves(loaded(PLACES[0], 1e9, 369), method),
        ),
        HardCase {
            name: "a crack: nodes in one place along half of a section",
            why: "what touches is not joined; nothing holds the faces of the crack together or apart",
            body: Some(BodyFigure {
                what: "difference of the frequencies from those with the crack opened by 1e-9, relative",
                figure: || {
                    difference(&solve(half_cracked(), STEEL, 8)?, &solve(opened(half_cracked(), 1e-9), STEEL, 8)?)
                },
                expected: Within(1e-6),
            }),
            measure: DRIFT,
            run: |method, _| moves(solve(half_cracked(), STEEL, 8), method),
            expected: TUMBLING,
        },
        refused("two pieces", "each has six rigid motions of its own", "pieces that share no node", |method, _| {
            moves(solve(cells_of([3.0, 1.0, 1.0], [3, 1, 1], |[x, _, _]| x != 1), METRES, 6), method)
        }),
        refused(
            "a crack right through: nodes in one place along a whole section",
            "it looks like one body and is two",
            "pieces that share no node",
            |method, _| {
                let parts = cracked(box_mesh([2.0, 1.0, 1.0], [2, 1, 1]), 1.0, |at| at[0] == 1.0);
                moves(solve(parts, METRES, 6), method)
            },
        ),
        refused(
            "a mechanism: two cubes that share an edge",
            "they turn against each other about it without strain",
            "the body is a mechanism",
            |method, _| moves(solve(cells_of([2.0, 2.0, 1.0], [2, 2, 1], |[x, y, _]| x == y), METRES, 6), method),
        ),
        refused(
            "a mechanism: two cubes that share a node",
            "they turn against each other about it in three ways",
            "the body is a mechanism",
            |method, _| moves(solve(cells_of([2.0; 3], [2; 3], |[x, y, z]| x == y && y == z), METRES, 6), method),
        ),
        refused(
            "an element inside out",
            "its volume and its mass are negative; its stiffness may pass for one",
            "is inverted",
            |method, _| {
                let mut parts = box_mesh([1.0; 3], [2; 3]);
                let [a, b, c, d, ab, bc, ac, ad, cd, bd] = parts.elements[7];
                parts.elements[7] = [a, b, d, c, ab, bd, ad, ac, cd, bc];
                moves(solve(parts, METRES, 6), method)
            },
        ),
        refused(
            "a mid-edge node drawn so far that its elements fold",
            "corners and edges are in order, but within an element the volume is negative in places",
            "is inverted",
            |method, _| {
                let mut parts = box_mesh([1.0; 3], [2; 3]);
                let middle = parts.elements[0][4] as usize - 1;
                parts.positions[middle][0] += 0.2;
                moves(solve(parts, METRES, 6), method)
            },
        ),
        refused(
            "two nodes of one number",
            "which of them an element means is not known",
            "node tag 5 is given twice",
            |method, _| {
                let mut parts = box_mesh([1.0; 3], [2; 3]);
                parts.node_tags[8] = 5;
                moves(solve(parts, METRES, 6), method)
            },
        ),
    ]
}

const METRES: Material = Material { young_modulus: 1.0, poisson_ratio: 0.3, density: 1.0 };
const STEEL: Material = Material { young_modulus: 2.1e11, poisson_ratio: 0.3, density: 7850.0 };
const STEEL_BAR: [f64; 3] = [1.0, 0.05, 0.07];
/// A quarter of the circle of radius 4.
const QUARTER: f64 = 2.0 * std::f64::consts::PI;

fn moves(elastic: Result<ElasticBody, String>, method: Method) -> TrialOutcome {
    on(elastic.map(|e| e.body), |body| tumble(body, method))
}

fn solve(parts: MeshParts, material: Material, flexible: usize) -> Result<ElasticBody, String> {
    solve_with(parts, material, &[], flexible)
}

fn solve_with(
    parts: MeshParts,
    material: Material,
    masses: &[PointMass],
    flexible: usize,
) -> Result<ElasticBody, String> {
    let mesh = Mesh::new(parts).map_err(|e| e.to_string())?;
    let matrices = assemble(&mesh, &Materials::Uniform(material), masses).map_err(|e| e.to_string())?;
    ElasticBody::solve(matrices.stiffness(), matrices.mass(), mesh.positions().to_vec(), flexible)
}

fn bar(size: [f64; 3], cells: [usize; 3], material: Material, flexible: usize) -> Result<ElasticBody, String> {
    solve(box_mesh(size, cells), material, flexible)
}

/// How far the lowest frequency is from that of a thin free beam of E = ρ = 1.
fn against_beam(size: [f64; 3], cells: [usize; 3]) -> Result<f64, String> {
    let found = bar(size, cells, METRES, 1)?.body.circular_frequencies[0];
    let expected = 22.373_285 / (size[0] * size[0]) * size[2] / 12.0_f64.sqrt();
    Ok((found / expected - 1.0).abs())
}

/// A cube of three layers, the middle one 5e-5 thick, the elements half as wide as the cube.
fn with_layer() -> Result<ElasticBody, String> {
    let mut parts = box_mesh([1.0, 1.0, 3.0], [2, 2, 3]);
    for x in &mut parts.positions {
        let thin = 5e-5;
        let below = 0.5 * (1.0 - thin);
        x[2] = if x[2] <= 1.0 {
            below * x[2]
        } else if x[2] <= 2.0 {
            below + thin * (x[2] - 1.0)
        } else {
            below + thin + below * (x[2] - 2.0)
        };
    }
    solve(parts, METRES, 8)
}

/// A bar of 1 × 1, its middle line a quarter of a circle of radius 4.
fn quarter_ring() -> Result<ElasticBody, String> {
    let mut parts = box_mesh([QUARTER, 1.0, 1.0], [4, 1, 1]);
    for x in &mut parts.positions {
        let (radius, angle) = (3.5 + x[1], x[0] / 4.0);
        *x = [radius * angle.sin(), radius * angle.cos(), x[2]];
    }
    solve(parts, METRES, 8)
}

/// The steel bar in µm, kg and s.
fn micrometres() -> Result<ElasticBody, String> {
    let material = Material { young_modulus: STEEL.young_modulus * 1e-6, density: STEEL.density * 1e-18, ..STEEL };
    bar(STEEL_BAR.map(|x| x * 1e6), [8, 2, 2], material, 8)
}

fn one_element() -> Result<ElasticBody, String> {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let middles = EDGES.map(|[a, b]: [usize; 2]| [0, 1, 2].map(|axis| 0.5 * (corners[a][axis] + corners[b][axis])));
    let parts = MeshParts {
        source: "one element".to_owned(),
        positions: corners.into_iter().chain(middles).collect(),
        elements: vec![[1, 2, 3, 4, 5, 6, 7, 8, 9, 10]],
        regions: vec![vec![]],
        ..MeshParts::default()
    };
    solve(numbered(parts), METRES, 24)
}

/// The steel bar with its nodes and elements in another order.
fn shuffled() -> Result<ElasticBody, String> {
    let mut parts = box_mesh(STEEL_BAR, [8, 2, 2]);
    let places = permutation(parts.positions.len());
    let mut positions = parts.positions.clone();
    for (x, place) in parts.positions.iter().zip(&places) {
        positions[*place] = *x;
    }
    parts.positions = positions;
    for nodes in &mut parts.elements {
        *nodes = nodes.map(|tag| places[tag as usize - 1] as u64 + 1);
    }
    let order = permutation(parts.elements.len());
    parts.elements = order.iter().map(|k| parts.elements[*k]).collect();
    solve(parts, STEEL, 8)
}

/// The numbers below `n` in an order that looks random: Fisher and Yates with Knuth's MMIX generator.
fn permutation(n: usize) -> Vec<usize> {
    let mut list: Vec<usize> = (0..n).collect();
    let mut state = 1_u64;
    for k in (1..n).rev() {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        list.swap(k, (state >> 33) as usize % (k + 1));
    }
    list
}

/// A mesh that is refused before anything can move.
fn refused(
    name: &'static str,
    why: &'static str,
    words: &'static str,
    run: fn(Method, Extent) -> TrialOutcome,
) -> HardCase {
    HardCase { name, why, body: None, measure: "–", run, expected: [Refused(words); 4] }
}

/// √(G/ρ)
fn shear_speed(material: Material) -> f64 {
    (material.young_modulus / (2.0 * (1.0 + material.poisson_ratio) * material.density)).sqrt()
}

/// The largest relative gap within groups of frequencies.
fn gap(elastic: &ElasticBody, groups: &[std::ops::Range<usize>]) -> Result<f64, String> {
    let frequencies = &elastic.body.circular_frequencies;
    Ok(groups.iter().map(|group| frequencies[group.end - 1] / frequencies[group.start] - 1.0).fold(0.0, f64::max))
}

/// Where the mass is in [`loaded`]: a corner of the cube, and five places in and around it.
const PLACES: [[f64; 3]; 6] = [
    [0.0, 0.0, 0.0],
    [-0.128, 0.224, 0.255],
    [-0.275, 0.037, 0.296],
    [-0.156, -0.29, -0.008],
    [0.05, -0.269, -0.203],
    [-0.291, -0.013, 0.284],
];

/// A cube with a mass of a multiple of its own, spread over the nodes around a place.
fn loaded(at: [f64; 3], times: f64, flexible: usize) -> Result<ElasticBody, String> {
    let mass = PointMass { at, mass: times, spread: Some(0.6) };
    solve_with(box_mesh([1.0; 3], [2; 3]), METRES, &[mass], flexible)
}

/// The steel bar, its section in the middle cracked from one side to its centre.
fn half_cracked() -> MeshParts {
    let [length, width, _] = STEEL_BAR;
    cracked(box_mesh(STEEL_BAR, [8, 2, 2]), 0.5 * length, |[x, y, _]| x == 0.5 * length && y < 0.49 * width)
}

/// The largest relative difference of the frequencies of two bodies.
fn difference(a: &ElasticBody, b: &ElasticBody) -> Result<f64, String> {
    let pairs = a.body.circular_frequencies.iter().zip(&b.body.circular_frequencies);
    Ok(pairs.map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max))
}
