//! Responses of bodies in joints with their rates: Eq. (D21) of `docs/method/gradients.md`.

use std::f64::consts::TAU;

use diagnostic::{Failure, Kind};
use faer::linalg::solvers::Solve;
use faer::{Mat, c64};
use nalgebra::Vector3;

use super::here::{Here, NumbersOfBody};
use super::number::Number;
use super::responses::{AXES, ResponseReport};
use super::varying::{Varying, product, times};
use crate::commands::linear::linearize::{acting_loads, input_channels};

/// Real and imaginary parts at each frequency.
type Values = Vec<[f64; 2]>;

/// Responses, by input, then output, with their rates by number; none of a load that follows the number in a way that is not known.
pub(crate) struct SystemResponses {
    pub responses: Vec<ResponseReport>,
    pub rates: Vec<Vec<Option<Values>>>,
}

/// An input or an output: forces, or a displacement, over the coordinates of all bodies.
struct Port {
    name: String,
    row: Vec<f64>,
    of: Of,
}

/// The place that it acts on or sees.
enum Of {
    /// A load, by its number in the scene of a body.
    Load { body: usize, load: usize },
    /// A displacement of a point of a body along an axis.
    Point { body: usize, point: usize, axis: usize },
    /// A coordinate of a joint, which markers have.
    Joint,
}

/// Rates of a port with a number of a body.
struct Followed {
    /// Forces of the port on the coordinates of the body that are none of its markers.
    direct: Vec<f64>,
    /// Their rates, on the coordinates of the body.
    rates: Vec<f64>,
}

impl Here<'_> {
    /// The responses at some frequencies, cycles per time; `stiffness_rates` are K' by each number that is a stiffness.
    pub fn responses(
        &self,
        numbers: &[Number],
        stiffness_rates: &[Option<Mat<f64>>],
        varied: &[Option<NumbersOfBody<'_>>],
        frequencies: &[f64],
    ) -> Result<SystemResponses, Failure> {
        if frequencies.is_empty() {
            return Ok(SystemResponses { responses: Vec::new(), rates: vec![Vec::new(); numbers.len()] });
        }
        let [inputs, outputs] = self.ports();
        let (first, count) = (inputs.len(), outputs.len());
        let pairs: Vec<(usize, usize)> = (0..first).flat_map(|i| (first..first + count).map(move |o| (i, o))).collect();
        let ports: Vec<&Port> = inputs.iter().chain(&outputs).collect();
        let changes = numbers.iter().zip(stiffness_rates).enumerate().map(|(i, (number, rate))| match rate {
            Some(rate) => Ok(Change::Stiffness(rate)),
            None => self.change_with(i, number, varied, &ports),
        });
        let changes: Vec<Change<'_>> = changes.collect::<Result<_, _>>()?;
        let linear = &self.steady.linear;
        let size = linear.size();
        let along =
            |j: usize, row: &[f64]| -> f64 { row.iter().enumerate().map(|(k, r)| r * linear.basis[(k, j)]).sum() };
        let right = Mat::from_fn(size, ports.len(), |j, port| c64::new(along(j, &ports[port].row), 0.0));
        let mut responses = vec![Values::new(); pairs.len()];
        let mut rates = vec![vec![Some(Values::new()); pairs.len()]; numbers.len()];
        for frequency in frequencies {
            let omega = TAU * frequency;
            let dynamic = Mat::from_fn(size, size, |i, j| {
                let own = if i == j { omega * omega } else { 0.0 };
                c64::new(linear.stiffness[(i, j)] - own, omega * linear.damping[(i, j)])
            });
            let moved = dynamic.partial_piv_lu().solve(&right);
            let is_known = |value: c64| value.re.is_finite() && value.im.is_finite();
            if (*frequency == 0.0 && self.is_loose) || !moved.col_iter().all(|x| x.iter().all(|x| is_known(*x))) {
                let words = format!(
                    "the response at {frequency} cycles per time has no end: an undamped vibration or a motion as a whole is there"
                );
                let help = "take other --frequencies, or give the bodies damping";
                return Err(Kind::Run.of(self.path()).help(help).says(words));
            }
            let coordinates: Vec<Vec<c64>> = moved.col_iter().map(|x| x.iter().copied().collect()).collect();
            let motions: Vec<Vec<c64>> = coordinates.iter().map(|x| times(&linear.basis, x)).collect();
            for (k, (i, o)) in pairs.iter().enumerate() {
                let value: c64 = (0..size).map(|j| right[(j, *o)] * coordinates[*i][j]).sum();
                responses[k].push([value.re, value.im]);
                for (change, rates) in changes.iter().zip(&mut rates) {
                    let rate = change.rate(c64::new(0.0, omega), [*i, *o], &coordinates, &motions);
                    match (rate, &mut rates[k]) {
                        (Some(rate), Some(values)) => values.push([rate.re, rate.im]),
                        (_, rates) => *rates = None,
                    }
                }
            }
        }
        let report = |((i, o), values): (&(usize, usize), Values)| ResponseReport {
            input: ports[*i].name.clone(),
            output: ports[*o].name.clone(),
            values,
        };
        Ok(SystemResponses { responses: pairs.iter().zip(responses).map(report).collect(), rates })
    }

    /// Loads and forces along joints; displacements of points and coordinates of joints.
    fn ports(&self) -> [Vec<Port>; 2] {
        let (motion, linear) = (self.motion.run.motion(), &self.steady.linear);
        let all = linear.basis.nrows();
        let [mut inputs, mut outputs] = [(); 2].map(|()| Vec::new());
        for (place, (body, state)) in self.motion.bodies.iter().zip(self.steady.states()).enumerate() {
            let (scene, model, own) = (&self.system.bodies[*body], &self.models[*body], linear.coordinates_of(place));
            let name = scene.name.as_ref().filter(|_| self.models.len() > 1);
            let prefix = name.map_or_else(String::new, |name| format!("{name}."));
            let over = |row: &[f64]| {
                let mut whole = vec![0.0; all];
                whole[own.clone()].copy_from_slice(row);
                whole
            };
            let units = motion.system().bodies()[place].unit_forces(&state);
            let channels = input_channels(scene, model, &prefix);
            for ((unit, channel), (load, _)) in units.iter().zip(channels).zip(acting_loads(scene, model)) {
                inputs.push(Port { name: channel.name, row: over(unit), of: Of::Load { body: *body, load } });
            }
            for (point, (name, shapes)) in model.points.iter().enumerate() {
                let arm = model.arm(shapes, &state.modal_displacement);
                let column = |k: usize| match k {
                    0..3 => Vector3::ith(k, 1.0),
                    3..6 => Vector3::ith(k - 3, 1.0).cross(&arm),
                    _ => shapes.columns()[k],
                };
                for (axis, letter) in AXES.iter().enumerate() {
                    let row: Vec<f64> = (0..own.len()).map(|k| column(k)[axis]).collect();
                    let name = format!("{prefix}{name}.displacement.{letter}");
                    outputs.push(Port { name, row: over(&row), of: Of::Point { body: *body, point, axis } });
                }
            }
        }
        for (number, joint) in self.motion.joints.iter().enumerate() {
            let of = &self.system.joints[*joint];
            for coordinate in of.kind.coordinates() {
                let row = motion.coordinate_row(&self.steady, number, *coordinate);
                for list in [&mut inputs, &mut outputs] {
                    list.push(Port {
                        name: format!("{}.{}", of.name, coordinate.name()),
                        row: row.clone(),
                        of: Of::Joint,
                    });
                }
            }
        }
        [inputs, outputs]
    }

    /// The change by a number of a body.
    fn change_with<'a>(
        &self,
        i: usize,
        number: &Number,
        varied: &'a [Option<NumbersOfBody<'a>>],
        ports: &[&Port],
    ) -> Result<Change<'a>, Failure> {
        let (body, of_body, k) = self.varying(i, number, varied)?;
        let rates = &of_body.body.rates[k];
        let followed = |port: &&Port| {
            let direct = || port.row[of_body.first..of_body.first + rates.mass.nrows()].to_vec();
            match port.of {
                Of::Load { body: of, load } if of == body => {
                    let direct = direct();
                    let rates = rates.loads.get(&load)?.on_coordinates(&direct);
                    Some(Followed { direct, rates })
                }
                Of::Point { body: of, point, axis } if of == body => {
                    // Rigid motions move a point as they do, whatever the number.
                    let own = rates.points[point].row(axis).iter().copied();
                    let rates = std::iter::repeat_n(0.0, 6).chain(own).collect();
                    Some(Followed { direct: direct(), rates })
                }
                _ => Some(Followed { direct: Vec::new(), rates: Vec::new() }),
            }
        };
        Ok(Change::Body { of_body, number: k, ports: ports.iter().map(followed).collect() })
    }
}

/// The change by a number.
enum Change<'a> {
    /// K of the independent coordinates, by this.
    Stiffness(&'a Mat<f64>),
    /// A body by one of its numbers, and the ports; none of a load that it changes in a way that is not known.
    Body { of_body: &'a Varying<'a>, number: usize, ports: Vec<Option<Followed>> },
}

impl Change<'_> {
    /// The rate of the response of an output to an input, in the coordinates and the motions that each of the ports makes.
    fn rate(&self, s: c64, ports: [usize; 2], coordinates: &[Vec<c64>], motions: &[Vec<c64>]) -> Option<c64> {
        match self {
            Self::Stiffness(rate) => {
                let [x, y] = ports.map(|port| &coordinates[port]);
                Some(-product(rate, x, y))
            }
            Self::Body { of_body, number, ports: followed } => {
                let [first, second] = ports.map(|port| followed[port].as_ref());
                let (first, second) = (first?, second?);
                let [x, y] = ports.map(|port| &motions[port][..]);
                let forces = [&first.direct[..], &second.direct[..]];
                let change = of_body.change(s, [x, y], forces, &of_body.body.rates[*number]);
                let along = |followed: &Followed, motion| -> c64 {
                    followed.rates.iter().zip(of_body.own(motion)).map(|(rate, x)| *x * *rate).sum()
                };
                Some(along(first, y) + along(second, x) - change)
            }
        }
    }
}
