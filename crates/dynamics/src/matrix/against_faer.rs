//! Products with the matrices of a body in the two layouts, against faer and plain rows: `./dev layouts` measures them in turn and
//! prints the table of `docs/evidence/factor.md`.

use std::hint::black_box;
use std::time::Instant;

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};
use pulp::{Arch, Simd, WithSimd};

use crate::matrix::blocked_matrix::BlockedMatrix;
use crate::matrix::four::{Group, Padded, WIDTH};
use crate::matrix::lists::dot;
use crate::matrix::side_by_side::{Lists, dots, own_products};
use crate::matrix::stack::{Places, Stack};

/// Coordinates of the bodies.
const SIZES: [usize; 5] = [6, 10, 20, 40, 80];
/// Matrices that have the same list to their right: the G_i and N_ij of a body.
const COUNT: usize = 9;
/// Turns, of which the fastest counts, and products in each.
const TURNS: usize = 200;
const PRODUCTS: usize = 200;

/// Lists of which the inertia has all products with each other.
const OWN: usize = 3;

struct StackProducts<'a> {
    stack: &'a Stack,
    x: &'a Padded,
    out: &'a mut [Group],
    with_sums: bool,
}

impl WithSimd for StackProducts<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for _ in 0..PRODUCTS {
            let out = Places { groups: &mut *self.out, width: COUNT, first: 0 };
            let x = black_box(self.x).groups();
            self.stack.multiply(simd, x, Lists::ZEROS, out);
            if self.with_sums {
                let lists = Lists { groups: self.out, width: COUNT, first: 0 };
                black_box((dots::<S, COUNT>(simd, lists, x), own_products::<S, OWN>(simd, lists)));
            }
        }
    }
}

/// Nanoseconds of a product, if this is faster than what was.
fn take(fastest: &mut f64, work: impl FnOnce()) {
    let started = Instant::now();
    work();
    *fastest = fastest.min(started.elapsed().as_secs_f64() * 1e9 / PRODUCTS as f64);
}

#[test]
#[ignore = "prints times"]
fn the_layouts_of_matrices_against_each_other() {
    println!(
        "| coordinates | stack, ns | blocks, ns | faer, ns | rows, ns | stack and sums, ns | blocks and sums, ns |"
    );
    println!("|---:|---:|---:|---:|---:|---:|---:|");
    for size in SIZES {
        let entry = |k: usize, i: usize, j: usize| ((k * 31 + i * 7 + j * 13) as f64).sin();
        let matrices: Vec<_> = (0..COUNT).map(|k| Mat::from_fn(size, size, |i, j| entry(k, i, j))).collect();
        let all = Mat::from_fn(COUNT * size, size, |i, j| entry(i / size, i % size, j));
        let rows: Vec<f64> =
            (0..COUNT * size).flat_map(|i| (0..size).map(move |j| (i, j))).map(|(i, j)| all[(i, j)]).collect();
        let (stack, blocks) = (Stack::new(&matrices), BlockedMatrix::new(all.as_ref()));
        let x: Vec<f64> = (0..size).map(|j| (j as f64).cos()).collect();
        let (padded, column) = (Padded::from_slice(&x), Mat::from_fn(size, 1, |j, _| x[j]));
        let mut groups = vec![[0.0; WIDTH]; COUNT * size.div_ceil(WIDTH)];
        let (mut list, mut product) = (vec![0.0; COUNT * size], Mat::zeros(COUNT * size, 1));
        let mut times = [f64::INFINITY; 6];
        for _ in 0..TURNS {
            for (time, with_sums) in [(0, false), (4, true)] {
                let products = StackProducts { stack: &stack, x: &padded, out: &mut groups, with_sums };
                take(&mut times[time], || Arch::new().dispatch(products));
            }
            take(&mut times[1], || (0..PRODUCTS).for_each(|_| blocks.multiply(black_box(&x), &mut list)));
            take(&mut times[2], || {
                for _ in 0..PRODUCTS {
                    matmul(&mut product, Accum::Replace, black_box(&all), &column, 1.0, Par::Seq);
                }
            });
            take(&mut times[3], || {
                for _ in 0..PRODUCTS {
                    for (y, row) in list.iter_mut().zip(black_box(&rows).chunks_exact(size)) {
                        *y = row.iter().zip(&x).map(|(a, x)| a * x).sum();
                    }
                }
            });
            take(&mut times[5], || {
                for _ in 0..PRODUCTS {
                    blocks.multiply(black_box(&x), &mut list);
                    let lists: [&[f64]; COUNT] = std::array::from_fn(|k| &list[k * size..(k + 1) * size]);
                    black_box(lists.map(|list| dot(list, &x)));
                    black_box(
                        (0..OWN)
                            .flat_map(|i| (0..=i).map(move |j| (i, j)))
                            .map(|(i, j)| dot(lists[i], lists[j]))
                            .sum::<f64>(),
                    );
                }
            });
            black_box((&groups, &list, &product));
        }
        let [stack, blocks, faer, rows, stack_and_sums, blocks_and_sums] = times;
        println!(
            "| {size} | {stack:.0} | {blocks:.0} | {faer:.0} | {rows:.0} | {stack_and_sums:.0} | {blocks_and_sums:.0} |"
        );
    }
}
