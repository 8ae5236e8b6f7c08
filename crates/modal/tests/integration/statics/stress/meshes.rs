//! Meshes of layers of prisms, made in code: flat triangles times layers, each prism cut into three tetrahedra, and all
//! nodes mapped into space.

use std::collections::HashMap;

use fem_tet10::{Mesh, MeshParts, SurfaceGroup};
use nalgebra::Vector3;

pub type Point = [f64; 3];

const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]];

/// The same for places that differ by rounding. It is shifted, so that no coordinate of these meshes is near a jump.
fn place_key(at: &Point) -> [i64; 3] {
    at.map(|c| (c * 1e7 + 0.3137).round() as i64)
}

/// A triangle cut into n² alike.
pub fn cut(corners: [Point; 3], n: usize) -> Vec<[Point; 3]> {
    let at = |i: usize, j: usize| -> Point {
        let [s, t] = [i as f64 / n as f64, j as f64 / n as f64];
        std::array::from_fn(|a| corners[0][a] * (1.0 - s - t) + corners[1][a] * s + corners[2][a] * t)
    };
    let mut parts = Vec::new();
    for i in 0..n {
        for j in 0..n - i {
            parts.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
            if i + j + 1 < n {
                parts.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    parts
}

/// The mesh of tetrahedra that are given by their corners in a flat space, which `map` takes into the body. The surface
/// group "loaded" is the faces whose corners are all `loaded` in the flat space.
pub fn mapped(tetrahedra: &[[Point; 4]], map: impl Fn(Point) -> Point, loaded: impl Fn(Point) -> bool) -> Mesh {
    let mut tags: HashMap<[i64; 3], u64> = HashMap::new();
    let mut positions: Vec<Point> = Vec::new();
    let mut tag = |flat: Point| {
        let at = map(flat);
        *tags.entry(place_key(&at)).or_insert_with(|| {
            positions.push(at);
            positions.len() as u64
        })
    };
    let middle = |a: Point, b: Point| -> Point { std::array::from_fn(|i| 0.5 * (a[i] + b[i])) };
    let (mut elements, mut triangles) = (Vec::new(), Vec::new());
    for corners in tetrahedra {
        let mut c = *corners;
        let [p, q, r, s] = c.map(|x| Vector3::from(map(x)));
        if (q - p).cross(&(r - p)).dot(&(s - p)) < 0.0 {
            c.swap(2, 3);
        }
        let mids = EDGES.map(|[a, b]| middle(c[a], c[b]));
        let all: Vec<u64> = c.iter().chain(&mids).map(|x| tag(*x)).collect();
        elements.push(<[u64; 10]>::try_from(all).unwrap());
        for left_out in 0..4 {
            let face: Vec<Point> = (0..4).filter(|i| *i != left_out).map(|i| c[i]).collect();
            if face.iter().all(|x| loaded(*x)) {
                let [a, b, d] = [face[0], face[1], face[2]];
                triangles.push([a, b, d, middle(a, b), middle(b, d), middle(d, a)].map(&mut tag));
            }
        }
    }
    Mesh::new(MeshParts {
        source: "made by a test".to_owned(),
        node_tags: (1..=positions.len() as u64).collect(),
        positions,
        element_tags: (1..=elements.len() as u64).collect(),
        regions: vec![vec![]],
        element_regions: vec![0; elements.len()],
        elements,
        surfaces: vec![SurfaceGroup {
            name: "loaded".to_owned(),
            triangle_tags: (1..=triangles.len() as u64).collect(),
            triangles,
        }],
        ..MeshParts::default()
    })
    .unwrap()
}

/// The tetrahedra of prisms whose lower and upper triangles `place` puts at two levels.
pub fn layers(triangles: &[[Point; 3]], levels: &[f64], place: impl Fn(Point, f64) -> Point) -> Vec<[Point; 4]> {
    let mut tetrahedra = Vec::new();
    for pair in levels.windows(2) {
        for triangle in triangles {
            // Sides are cut from the corner that comes first in space, whichever prism they belong to.
            let mut corners = *triangle;
            corners.sort_by_key(place_key);
            let [a, b, c] = corners.map(|x| place(x, pair[0]));
            let [d, e, f] = corners.map(|x| place(x, pair[1]));
            tetrahedra.extend([[a, b, c, f], [a, b, e, f], [a, d, e, f]]);
        }
    }
    tetrahedra
}

pub fn levels(from: f64, to: f64, count: usize) -> Vec<f64> {
    (0..=count).map(|i| from + (to - from) * i as f64 / count as f64).collect()
}

/// A hollow sphere between two radii, loaded inside. Each octant is a triangle cut into n².
pub fn hollow_sphere(inner: f64, outer: f64, n: usize, radial: usize) -> Mesh {
    let mut triangles = Vec::new();
    for [sx, sy, sz] in
        [[1, 1, 1], [1, 1, -1], [1, -1, 1], [1, -1, -1], [-1, 1, 1], [-1, 1, -1], [-1, -1, 1], [-1, -1, -1]]
    {
        let corner = |sign: i32, axis: usize| -> Point {
            std::array::from_fn(|a| if a == axis { f64::from(sign) } else { 0.0 })
        };
        triangles.extend(cut([corner(sx, 0), corner(sy, 1), corner(sz, 2)], n));
    }
    let flat = layers(&triangles, &levels(inner, outer, radial), |x, r| x.map(|c| c * r));
    let map = |x: Point| {
        let v = Vector3::from(x);
        (v * (v.lp_norm(1) / v.norm())).into()
    };
    mapped(&flat, map, |x| Vector3::from(x).lp_norm(1) < inner * (1.0 + 1e-9))
}

/// A disc about z, its middle plane z = 0, with n elements along a radius.
pub fn disc(radius: f64, thickness: f64, n: usize, across: usize) -> Mesh {
    let mut triangles = Vec::new();
    for [sx, sy] in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
        triangles.extend(cut([[0.0; 3], [sx * radius, 0.0, 0.0], [0.0, sy * radius, 0.0]], n));
    }
    let flat = layers(&triangles, &levels(-0.5 * thickness, 0.5 * thickness, across), |[x, y, _], z| [x, y, z]);
    let map = |[x, y, z]: Point| {
        let (sum, root) = (x.abs() + y.abs(), x.hypot(y));
        let factor = if root > 0.0 { sum / root } else { 1.0 };
        [x * factor, y * factor, z]
    };
    mapped(&flat, map, |_| false)
}

/// A plate about z, from its hole at radius `hole` out to `outer(angle)`, in n steps for an eighth of the round and along
/// the radius, which grow from the hole outward.
pub fn holed(
    hole: f64,
    outer: impl Fn(f64) -> f64,
    thickness: f64,
    n: usize,
    radial: usize,
    loaded: impl Fn(Point) -> bool,
) -> Mesh {
    let (mut triangles, steps) = (Vec::new(), 8 * n);
    for i in 0..steps {
        for j in 0..radial {
            let at = |i: usize, j: usize| [i as f64 / steps as f64, j as f64 / radial as f64, 0.0];
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            // Mirrored from eighth to eighth.
            if (i / n).is_multiple_of(2) {
                triangles.extend([[a, b, c], [a, c, d]]);
            } else {
                triangles.extend([[a, b, d], [b, c, d]]);
            }
        }
    }
    let flat = layers(&triangles, &[-0.5 * thickness, 0.5 * thickness], |[s, t, _], z| [s, t, z]);
    let map = |[s, t, z]: Point| {
        let angle = std::f64::consts::TAU * s;
        let r = hole * (outer(angle) / hole).powf(t);
        [r * angle.cos(), r * angle.sin(), z]
    };
    let loaded = |x: Point| loaded(map(x));
    mapped(&flat, map, loaded)
}
