//! The constants of a body, its effects and its drive.

use faer::Mat;
use nalgebra::{Matrix3, Vector3};
use reduced_body::ReducedBody;
use rigid_kin::Attitude;

use crate::body::center_of_mass::CenterOfMass;
use crate::body::effect::{Effect, EffectMap};
use crate::body::physics::{Drive, DrivenMotion, Physics, check_stiffness};
use crate::body::spin_stiffness::SpinStiffness;
use crate::conservative::body::{ConservativeBody, Translation};
use crate::conservative::coordinates::InCoordinates;
use crate::conservative::frame::Frame;
use crate::conservative::manifold::Manifold;
use crate::conservative::reference::Reference;
use crate::conservative::state;
use crate::error::SetupError;
use crate::load::SharedLoad;
use crate::matrix::blocked_matrix::BlockedMatrix;
use crate::matrix::four::Padded;
use crate::matrix::side_by_side::side_by_side;
use crate::matrix::stack::Stack;
use crate::observation::reaction::Held;
use crate::vibration::own_coupling::own_coupling;

impl ConservativeBody {
    /// A body with one damping ratio for each flexible mode, and loads.
    ///
    /// # Errors
    /// [`SetupError`] for a list of the wrong length, numbers that are negative or not finite, and a drive of a body
    /// that is not clamped.
    pub fn new(
        body: &ReducedBody,
        damping_ratios: &[f64],
        loads: Vec<SharedLoad>,
        physics: &Physics,
    ) -> Result<Self, SetupError> {
        crate::body::model::check_motion(body)?;
        crate::body::model::check_damping(damping_ratios, body.flexible())?;
        let Physics { effects, drive, drive_stiffness, large_deflection, reference, coupling: between } = physics;
        if let Some(reference) = reference {
            reference.check(body.flexible())?;
        }
        if let Some(between) = between {
            check_stiffness("the stiffness between coordinates", between, body.flexible())?;
        }
        let (modes, manifold) = (body, large_deflection.as_ref());
        let body = manifold.map_or(modes, Manifold::body);
        let nf = body.flexible();
        loads.iter().try_for_each(|load| load.check(nf))?;
        let drive_stiffness = drive_stiffness.as_ref().filter(|_| drive.is_some());
        check_lengths(modes, manifold, drive_stiffness, nf)?;
        let driven = drive.as_ref().map(|drive| driven_motion(drive, body)).transpose()?;
        let (translation, axes) = degrees_of_freedom(body, effects, driven);
        let turn_driven = matches!(driven, Some(DrivenMotion::Turn { .. }));
        let damping: Vec<f64> =
            modes.circular_frequencies.iter().zip(damping_ratios).map(|(omega, zeta)| 2.0 * zeta * omega).collect();
        let inertia = along_axes(&axes, &body.inertia);

        let follows = effects[Effect::DeformedInertia];
        // It needs the N_ij: where they are off, it would cost more than it saves.
        let locked = effects[Effect::Coriolis] && follows && !turn_driven && manifold.is_none();
        let pairs: Vec<(usize, usize)> = match axes.len() {
            3 if nf > 0 && follows => ReducedBody::PAIRS.to_vec(),
            1 if nf > 0 && follows => vec![(0, 0)],
            _ => Vec::new(),
        };
        let size = manifold.map_or(nf, Manifold::size);
        let turning = if size > 0 { axes.len() } else { 0 };
        let g_count = if effects[Effect::Coriolis] { turning } else { 0 };
        let s_count = if effects[Effect::Coriolis] || turn_driven { turning } else { 0 };
        let stiffness = body.stress_stiffness.as_ref().filter(|_| effects[Effect::GeometricStiffening]);
        let stiffness = stiffness.map(|stiffness| SpinStiffness::new(stiffness, manifold));
        let constants = InCoordinates { body, manifold };
        let pair_weights: Vec<[f64; 6]> =
            pairs.iter().map(|(i, j)| ReducedBody::pair_weights([&axes[*i], &axes[*j]])).collect();
        let gyroscopic: Vec<Mat<f64>> = axes[..g_count].iter().map(|axis| constants.gyroscopic(axis)).collect();
        let mut second: Vec<Mat<f64>> =
            pair_weights.iter().map(|weights| constants.inertia_second(weights, stiffness.as_ref())).collect();
        let coupling = own_coupling(&modes.circular_frequencies, [&second, &gyroscopic]);
        if locked {
            for (second, (i, j)) in second.iter_mut().zip(&pairs) {
                let product = &gyroscopic[*i] * &gyroscopic[*j];
                *second += (&product + product.transpose()) * faer::Scale(0.5);
            }
        }
        let of_axis = |axis: &Vector3<f64>| match turn_driven {
            true => constants.along(axis, &body.rotation_first),
            false => vec![0.0; size],
        };
        let of_pairs = pair_weights.iter().map(|weights| constants.inertia_first(weights));
        let undeformed: Vec<Vec<f64>> = axes[..s_count].iter().map(of_axis).chain(of_pairs).collect();
        let with_highest = physics.with_highest(&modes.circular_frequencies);
        let rates = with_highest.iter().chain(&damping);
        Ok(Self {
            layout: state::layout(&axes, modes.flexible()),
            initial_attitude: Attitude::identity(),
            mass: body.mass,
            origin: body.origin,
            frame: Frame::GLOBAL,
            center: CenterOfMass::new(body),
            inverse_inertia: inertia.try_inverse().unwrap_or_else(Matrix3::zeros),
            inertia,
            circular_frequencies: modes.circular_frequencies.clone(),
            with_highest: with_highest.clone(),
            damping_ratios: damping_ratios.to_vec(),
            natural_modes: modes.natural_modes,
            stiffness: modes.circular_frequencies.iter().map(|omega| omega * omega).collect(),
            fastest_rate: rates.copied().fold(0.0, f64::max),
            damped: damping.iter().any(|d| *d > 0.0),
            damping: Padded::from_slice(&damping),
            pairs,
            locked,
            undeformed: side_by_side(&undeformed),
            sliding: match translation {
                Translation::Driven(direction) => constants.along(&direction, &body.translation_first),
                _ => Vec::new(),
            },
            translation,
            axis_columns: Matrix3::from_fn(|i, k| axes.get(k).map_or(0.0, |axis| axis[i])),
            axes,
            turn_driven,
            drive: drive.clone(),
            s_count,
            g_count,
            own_coupling: coupling,
            matrices: Stack::new(&gyroscopic.iter().chain(&second).cloned().collect::<Vec<_>>()),
            gyroscopic: Stack::new(&gyroscopic),
            drive_stiffness: drive_stiffness.map(|k| BlockedMatrix::new(k.get(..modes.flexible(), ..modes.flexible()))),
            loads,
            manifold: large_deflection.clone(),
            reference: Reference::of(reference.as_ref(), between.as_ref()),
            held: Held::new(body, stiffness.as_ref(), effects),
        })
    }
}

/// Refuses a manifold of other modes, and a stiffness of other shapes than `nf`.
fn check_lengths(
    modes: &ReducedBody,
    manifold: Option<&Manifold>,
    drive_stiffness: Option<&Mat<f64>>,
    nf: usize,
) -> Result<(), SetupError> {
    if let Some(found) = manifold.map(Manifold::modes).filter(|found| *found != modes.flexible()) {
        let what = "the modes of the manifold of large deflection";
        return Err(SetupError::Length { what, expected: modes.flexible(), found });
    }
    let mut sizes = drive_stiffness.into_iter().flat_map(|k| [k.nrows(), k.ncols()]);
    match sizes.find(|found| *found != nf) {
        Some(found) => {
            let what = "a row or column of the geometric stiffness of the drive";
            Err(SetupError::Length { what, expected: nf, found })
        }
        None => Ok(()),
    }
}

/// Drive of a body, which must be clamped.
fn driven_motion(drive: &Drive, body: &ReducedBody) -> Result<DrivenMotion, SetupError> {
    drive.check()?;
    if body.motion.count() > 0 {
        return Err(SetupError::DriveOfFreeBody { motion: Box::new(body.motion) });
    }
    Ok(drive.motion)
}

/// How the origin moves, and what the body turns about.
fn degrees_of_freedom(
    body: &ReducedBody,
    effects: &EffectMap<bool>,
    driven: Option<DrivenMotion>,
) -> (Translation, Vec<Vector3<f64>>) {
    let (translation, axes) = match driven {
        Some(DrivenMotion::Turn { axis }) => (Translation::None, vec![axis]),
        Some(DrivenMotion::Slide { direction }) => (Translation::Driven(direction), Vec::new()),
        None => {
            let translation = match body.motion.translations() {
                [] => Translation::None,
                [direction] => Translation::Along(*direction),
                _ => Translation::Free,
            };
            (translation, body.motion.rotations().to_vec())
        }
    };
    let is_driven = driven.is_some();
    (
        if effects[Effect::Translation] || is_driven { translation } else { Translation::None },
        if effects[Effect::Rotation] || is_driven { axes } else { Vec::new() },
    )
}

/// A matrix in the axes of rotation, 1 on the diagonal of those that are missing.
fn along_axes(axes: &[Vector3<f64>], matrix: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| match (axes.get(i), axes.get(j)) {
        (Some(a), Some(b)) => a.dot(&(matrix * b)),
        _ => f64::from(u8::from(i == j)),
    })
}
