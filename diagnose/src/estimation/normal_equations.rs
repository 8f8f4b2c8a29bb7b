//! Normal equations, one set a block: sums of products of residuals and sensitivities.
//!
//! They are kept for each block, because leaving out blocks, for held-out figures and for intervals, is then a matter of
//! not adding them.

use nalgebra::{DMatrix, DVector, DVectorView};
use rayon::prelude::*;

use super::blocks::{Block, Blocks};
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

/// Normal equations of old coordinates, whose sensitivities and products stay as they are, together with those of added
/// coordinates. The residuals are those of `added`.
#[must_use]
pub fn extended(
    blocks: &Blocks,
    old: &[NormalEquations],
    base: &[Sensitivity],
    added: &[Sensitivity],
) -> Vec<NormalEquations> {
    (blocks.as_slice().iter().zip(old))
        .map(|(b, old)| {
            let (base, added) = (&base[b.recording], &added[b.recording]);
            let before = old.g.len();
            let p = before + added.columns.len();
            let (mut h, mut g) = (DMatrix::zeros(p, p), DVector::zeros(p));
            h.view_mut((0, 0), (before, before)).copy_from(&old.h);
            let mut cost = 0.0;
            for (c, residual) in added.residual.iter().enumerate() {
                let r = b.of(residual);
                cost += dot(r, r);
                let (known, new) = (answers(b, &base.columns, c), answers(b, &added.columns, c));
                for &(k, column) in &known {
                    g[k] += dot(column, r);
                }
                for (at, &(i, own)) in new.iter().enumerate() {
                    g[before + i] += dot(own, r);
                    for &(k, other) in &known {
                        let value = dot(own, other);
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
    added: &[Sensitivity],
) -> Vec<NormalEquations> {
    (blocks.as_slice().iter().zip(old))
        .map(|(b, old)| {
            let (base, added) = (&base[b.recording], &added[b.recording]);
            let (mut g, mut cost) = (DVector::zeros(old.g.len()), 0.0);
            for (c, residual) in added.residual.iter().enumerate() {
                let r = b.of(residual);
                cost += dot(r, r);
                for (k, column) in answers(b, &base.columns, c) {
                    g[k] += dot(column, r);
                }
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
        .filter(|(_, column)| column.iter().any(|v| *v != 0.0))
        .collect()
}

/// nalgebra adds eight sums side by side, which one processor does at once; one sum after the other took a quarter of a diagnosis.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    DVectorView::from_slice(a, a.len()).dot(&DVectorView::from_slice(b, b.len()))
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
        let grown = extended(blocks, &assemble(blocks, &base), &base, &at(&[2, 3]));
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
        let renewed = extended_with_residuals(blocks, &grown, &base, &added);
        assert!(assemble(blocks, &moved).iter().zip(&renewed).all(|(a, b)| close(a, b)));
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
