//! Normal equations, one set a block: sums of products of residuals and sensitivities.
//!
//! They are kept for each block, because leaving out blocks, for held-out figures and for intervals, is then a matter of
//! not adding them.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::blocks::{Block, Blocks};
use super::dot::dot;
use super::evaluation::Sensitivity;
use crate::specimen::Series;

/// Normal equations of one block at a point: `cost(z + d) = cost - 2 g d + d H d` in the linear approximation.
#[derive(Debug, Clone)]
pub struct NormalEquations {
    /// `J^T J`, where `J = d predicted / d z / noise`.
    pub h: DMatrix<f64>,
    /// `J^T r`, where `r = (measured - predicted) / noise`.
    pub g: DVector<f64>,
    /// `r^T r`.
    pub cost: f64,
}

impl NormalEquations {
    /// The cost after a step, in the linear approximation.
    #[must_use]
    pub fn cost_after(&self, step: &DVector<f64>) -> f64 {
        (self.cost - 2.0 * self.g.dot(step) + step.dot(&(&self.h * step))).max(0.0)
    }
}

/// Sums residuals and sensitivities of every block.
#[must_use]
pub fn assemble(blocks: &Blocks, sensitivities: &[Sensitivity]) -> Vec<NormalEquations> {
    (blocks.as_slice().par_iter())
        .map(|b| {
            let s = &sensitivities[b.recording];
            let p = s.columns.len();
            let (mut h, mut g, mut cost) = (DMatrix::zeros(p, p), DVector::zeros(p), 0.0);
            for (c, residual) in s.residual.iter().enumerate() {
                let r = b.of(residual);
                cost += dot(r, r);
                let columns = answers(b, &s.columns, c);
                for (at, &(i, column)) in columns.iter().enumerate() {
                    g[i] += dot(column, r);
                    for &(j, other) in &columns[..=at] {
                        h[(i, j)] += dot(column, other);
                    }
                }
            }
            h.fill_upper_triangle_with_lower_triangle();
            NormalEquations { h, g, cost }
        })
        .collect()
}

/// The same with new residuals; the sensitivities are those that `old` was assembled from.
#[must_use]
pub fn with_residuals(blocks: &Blocks, old: &[NormalEquations], sensitivities: &[Sensitivity]) -> Vec<NormalEquations> {
    (blocks.as_slice().par_iter().zip(old))
        .map(|(b, old)| {
            let s = &sensitivities[b.recording];
            let (mut g, mut cost) = (DVector::zeros(s.columns.len()), 0.0);
            for (c, residual) in s.residual.iter().enumerate() {
                let r = b.of(residual);
                cost += dot(r, r);
                for (i, column) in answers(b, &s.columns, c) {
                    g[i] += dot(column, r);
                }
            }
            NormalEquations {
                h: old.h.clone(),
                g,
                cost,
            }
        })
        .collect()
}

/// What is known of sensitivities before others are added to them: the coordinates by which each channel changes within each block, and the products
/// with its residual. Both mean reading all columns, which takes as long as a simulation, and screening extends the same ones hundreds of times. A
/// candidate leaves most channels as they are if it is at an instrument or at the rod.
#[derive(Debug)]
pub struct Answering {
    /// By block, then by channel.
    by_block: Vec<Vec<Answers>>,
}

/// The coordinates by which a channel changes within a block, each with the product of its column and the residual.
type Answers = Vec<(usize, f64)>;

impl Answering {
    /// Looks through all columns.
    #[must_use]
    pub fn of(blocks: &Blocks, sensitivities: &[Sensitivity]) -> Self {
        let by_block = (blocks.as_slice().par_iter())
            .map(|b| {
                let s = &sensitivities[b.recording];
                (s.residual.iter().enumerate())
                    .map(|(c, residual)| {
                        (answers(b, &s.columns, c).into_iter())
                            .map(|(k, column)| (k, dot(column, b.of(residual))))
                            .collect()
                    })
                    .collect()
            })
            .collect();
        Self { by_block }
    }
}

/// Adds the products of a channel's columns with a residual to `g`. Where the residual is the one that they are known of, nothing is read anew.
fn add_products(
    g: &mut DVector<f64>,
    answers: &[(usize, f64)],
    (block, base, channel): (&Block, &Sensitivity, usize),
    residual: &[f64],
) {
    if are_same(residual, block.of(&base.residual[channel])) {
        for &(k, product) in answers {
            g[k] += product;
        }
    } else {
        for &(k, _) in answers {
            g[k] += dot(block.of(&base.columns[k][channel]), residual);
        }
    }
}

/// Normal equations of old coordinates, whose sensitivities and products stay as they are, together with those of added
/// coordinates. The residuals are those of `added`, by recording; where it says nothing, the added coordinates change nothing. `answering` is what is
/// known of `base`.
#[must_use]
pub fn extended(
    blocks: &Blocks,
    old: &[NormalEquations],
    base: &[Sensitivity],
    answering: &Answering,
    added: &[Option<&Sensitivity>],
) -> Vec<NormalEquations> {
    let coordinates = added.iter().flatten().next().map_or(0, |s| s.columns.len());
    (blocks.as_slice().iter().zip(old).zip(&answering.by_block))
        .map(|((b, old), answering)| {
            let before = old.g.len();
            let p = before + coordinates;
            let (mut h, mut g) = (DMatrix::zeros(p, p), DVector::zeros(p));
            h.view_mut((0, 0), (before, before)).copy_from(&old.h);
            let (base, Some(added)) = (&base[b.recording], added[b.recording]) else {
                g.rows_mut(0, before).copy_from(&old.g);
                return NormalEquations { h, g, cost: old.cost };
            };
            let mut cost = 0.0;
            for (c, residual) in added.residual.iter().enumerate() {
                let r = b.of(residual);
                cost += dot(r, r);
                let new = answers(b, &added.columns, c);
                add_products(&mut g, &answering[c], (b, base, c), r);
                for (at, &(i, own)) in new.iter().enumerate() {
                    g[before + i] += dot(own, r);
                    for &(k, _) in &answering[c] {
                        let value = dot(own, b.of(&base.columns[k][c]));
                        h[(before + i, k)] += value;
                        h[(k, before + i)] += value;
                    }
                    for &(j, other) in &new[..=at] {
                        let value = dot(own, other);
                        h[(before + i, before + j)] += value;
                        if i != j {
                            h[(before + j, before + i)] += value;
                        }
                    }
                }
            }
            NormalEquations { h, g, cost }
        })
        .collect()
}

/// The same with new residuals, those of `added`; all sensitivities are those that `old` was extended from.
#[must_use]
pub fn extended_with_residuals(
    blocks: &Blocks,
    old: &[NormalEquations],
    base: &[Sensitivity],
    answering: &Answering,
    added: &[Option<&Sensitivity>],
) -> Vec<NormalEquations> {
    (blocks.as_slice().iter().zip(old).zip(&answering.by_block))
        .map(|((b, old), answering)| {
            let (base, Some(added)) = (&base[b.recording], added[b.recording]) else {
                return old.clone();
            };
            let (mut g, mut cost) = (DVector::zeros(old.g.len()), 0.0);
            for (c, residual) in added.residual.iter().enumerate() {
                let r = b.of(residual);
                cost += dot(r, r);
                add_products(&mut g, &answering[c], (b, base, c), r);
                for (k, column) in answers(b, &added.columns, c) {
                    g[base.columns.len() + k] += dot(column, r);
                }
            }
            let h = old.h.clone();
            NormalEquations { h, g, cost }
        })
        .collect()
}

/// `H` and `g` of all blocks with the prior, at coordinates `z`.
#[must_use]
pub fn sum<'n>(
    blocks: impl IntoIterator<Item = &'n NormalEquations>,
    prior: &DVector<f64>,
    z: &[f64],
) -> (DMatrix<f64>, DVector<f64>) {
    let p = prior.len();
    let (mut h, mut g) = (DMatrix::zeros(p, p), DVector::zeros(p));
    for n in blocks {
        h += &n.h;
        g += &n.g;
    }
    for k in 0..p {
        h[(k, k)] += prior[k];
        g[k] -= prior[k] * z[k];
    }
    (h, g)
}

/// Sum of the blocks' costs.
#[must_use]
pub fn total_cost(blocks: &[NormalEquations]) -> f64 {
    blocks.iter().map(|n| n.cost).sum()
}

/// The coordinates by which a channel changes within a block, with their derivatives. A law at the seal changes the force only, an instrument its own
/// channel, and a law over a quantity only what happens where the quantity is: most products would be of zeros.
fn answers<'s>(block: &Block, columns: &'s [Series], channel: usize) -> Vec<(usize, &'s [f64])> {
    (columns.iter().map(|column| block.of(&column[channel])).enumerate())
        .filter(|(_, column)| changes(column))
        .collect()
}

/// Whether anything in a series is not zero. Many at once are looked at, without their signs: a channel that does not answer is looked through to its end.
fn changes(series: &[f64]) -> bool {
    let (many, left) = series.as_chunks::<16>();
    let any = |values: &[f64]| values.iter().fold(0, |bits, v| bits | (v.to_bits() << 1)) != 0;
    many.iter().any(|values| any(values)) || any(left)
}

/// Whether two series of the same length have the same bits.
fn are_same(one: &[f64], other: &[f64]) -> bool {
    let ((many, left), (many_other, left_other)) = (one.as_chunks::<16>(), other.as_chunks::<16>());
    let differ =
        |a: &[f64], b: &[f64]| (a.iter().zip(b)).fold(0, |bits, (a, b)| bits | (a.to_bits() ^ b.to_bits())) != 0;
    !many.iter().zip(many_other).any(|(a, b)| differ(a, b)) && !differ(left, left_other)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{CUBIC, FRICTION, RUN, Recipe};
    use crate::estimation::{LeastSquares, Point};

    fn close(a: &NormalEquations, b: &NormalEquations) -> bool {
        let near = |x: f64, y: f64| (x - y).abs() <= 1e-9 * (1.0 + x.abs());
        a.h.iter().zip(b.h.iter()).all(|(x, y)| near(*x, *y))
            && a.g.iter().zip(b.g.iter()).all(|(x, y)| near(*x, *y))
            && near(a.cost, b.cost)
    }

    fn of_all(added: &[Sensitivity]) -> Vec<Option<&Sensitivity>> {
        added.iter().map(Some).collect()
    }

    #[test]
    fn where_nothing_was_simulated_added_coordinates_change_nothing() {
        let specimen = Recipe::default().make();
        let problem = LeastSquares::new(&specimen, &RUN);
        let (blocks, evaluation) = (&problem.blocks, &problem.evaluation);
        let point = Point::nominal(&specimen).with_effect(&specimen, CUBIC, &[0.1]);
        let at = |columns: &[usize]| evaluation.sensitivities(&point, columns, None).expect("simulated");
        let (base, added) = (at(&[0, 1]), at(&[2]));
        let old = assemble(blocks, &base);
        let answering = Answering::of(blocks, &base);
        let mut first_only = vec![None; added.len()];
        first_only[0] = Some(&added[0]);
        let whole = extended(blocks, &old, &base, &answering, &of_all(&added));
        let some = extended(blocks, &old, &base, &answering, &first_only);
        let mut moved = added.clone();
        for s in &mut moved {
            s.residual.iter_mut().flatten().for_each(|r| *r += 0.3);
        }
        let mut first_moved = vec![None; added.len()];
        first_moved[0] = Some(&moved[0]);
        let renewed = extended_with_residuals(blocks, &some, &base, &answering, &first_moved);
        for (k, b) in blocks.as_slice().iter().enumerate() {
            if b.recording == 0 {
                assert!(close(&some[k], &whole[k]) && !close(&renewed[k], &some[k]));
            } else {
                let unchanged = NormalEquations {
                    h: old[k].h.clone().resize(3, 3, 0.0),
                    g: old[k].g.clone().resize_vertically(3, 0.0),
                    cost: old[k].cost,
                };
                assert!(close(&some[k], &unchanged) && close(&renewed[k], &unchanged));
            }
        }
    }

    #[test]
    fn three_ways_of_assembling_agree() {
        let specimen = Recipe::default().make();
        let problem = LeastSquares::new(&specimen, &RUN);
        let (blocks, evaluation) = (&problem.blocks, &problem.evaluation);
        let point = Point::nominal(&specimen)
            .with_effect(&specimen, CUBIC, &[0.1])
            .with_effect(&specimen, FRICTION, &[0.05]);
        let at = |columns: &[usize]| evaluation.sensitivities(&point, columns, None).expect("simulated");
        let all = at(&[0, 1, 2, 3]);
        let whole = assemble(blocks, &all);
        // Old coordinates frozen, new ones added.
        let base = at(&[0, 1]);
        let answering = Answering::of(blocks, &base);
        let added = at(&[2, 3]);
        let grown = extended(blocks, &assemble(blocks, &base), &base, &answering, &of_all(&added));
        assert!(whole.iter().zip(&grown).all(|(a, b)| close(a, b)));
        // New residuals, the same sensitivities.
        let mut moved = all.clone();
        for s in &mut moved {
            s.residual.iter_mut().flatten().for_each(|r| *r += 0.3);
        }
        let renewed = with_residuals(blocks, &whole, &moved);
        assert!(assemble(blocks, &moved).iter().zip(&renewed).all(|(a, b)| close(a, b)));
        let mut added = at(&[2, 3]);
        for s in &mut added {
            s.residual.iter_mut().flatten().for_each(|r| *r += 0.3);
        }
        let renewed = extended_with_residuals(blocks, &grown, &base, &answering, &of_all(&added));
        assert!(assemble(blocks, &moved).iter().zip(&renewed).all(|(a, b)| close(a, b)));
        // The old residuals, whose products are known, and the same with one sample changed.
        let mut added = at(&[2, 3]);
        for changed in [0.0, 0.5] {
            added[0].residual[0][5] += changed;
            let mut moved = all.clone();
            moved[0].residual[0][5] += changed;
            let renewed = extended_with_residuals(blocks, &grown, &base, &answering, &of_all(&added));
            assert!(assemble(blocks, &moved).iter().zip(&renewed).all(|(a, b)| close(a, b)));
        }
    }

    #[test]
    fn the_linear_cost_is_that_of_the_moved_model() {
        let specimen = Recipe::default().make();
        let problem = LeastSquares::new(&specimen, &RUN);
        let point = Point::nominal(&specimen).with_effect(&specimen, CUBIC, &[0.1]);
        let normals = assemble(
            &problem.blocks,
            &problem
                .evaluation
                .sensitivities(&point, &[0, 1, 2], None)
                .expect("simulated"),
        );
        let step = DVector::from_vec(vec![0.4, -0.3, 0.7]);
        let mut moved = point;
        moved.z.iter_mut().zip(step.iter()).for_each(|(z, d)| *z += d);
        let residuals = problem.evaluation.residuals_at(&moved).expect("simulated");
        for (n, cost) in normals.iter().zip(problem.block_costs(&residuals)) {
            assert!(
                (n.cost_after(&step) / cost - 1.0).abs() < 1e-6,
                "{} {cost}",
                n.cost_after(&step)
            );
        }
    }
}
